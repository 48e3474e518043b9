#include <numeric>

#include "dvi/labels/labels.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const cv::Size size(8, 6);
  for (const auto& [number, labels] : labels::read_mots(put(folder / "mots_instances.txt", bytes), size))
    for (const Label& label : labels) {
      const std::vector<std::uint32_t>& runs = label.instance->runs;
      require(std::accumulate(runs.begin(), runs.end(), std::int64_t{0}) == size.area(), "runs fill the image");
    }
}
