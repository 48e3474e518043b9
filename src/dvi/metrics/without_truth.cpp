#include "dvi/metrics/without_truth.h"

namespace dvi::metrics {

FiguresWithoutTruth measure_without_truth(const fs::path& out, const std::vector<std::string>& names, const BeginPart& begin) {
  FiguresWithoutTruth figures;
  figures.artifacts = count_artifacts(out, names, begin("artifacts", names.size()));
  figures.look = measure_look(out, names, begin("look", names.size()));
  return figures;
}

}  // namespace dvi::metrics
