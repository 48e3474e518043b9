#include "dvi/exports/labeled_scans.h"

namespace dvi::exports {

std::vector<bool> find_removed_points(const LabeledScans& scans, std::size_t scan) {
  const auto labels = scans.labels[scan];
  std::vector<bool> out;
  out.reserve(labels->values.size());
  for (const std::uint32_t label : labels->values) out.push_back(label != 0);
  return out;
}

}  // namespace dvi::exports
