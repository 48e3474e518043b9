#include "dvi/result/source_masks.h"

#include <fmt/format.h>

#include "dvi/media/write_image.h"

namespace dvi::result {

std::string source_mask_file(std::size_t number) { return fmt::format(".dvi/masks/{:06d}.png", number); }

std::vector<std::string> SourceMasks::write(const cv::Mat_<cv::Vec3w>& provenance) {
  const std::size_t own = views_.targets();
  std::set<std::size_t> sources;
  for (const cv::Vec3w& from : provenance)
    if (from[0] > own) sources.insert(from[0] - std::size_t{1});
  std::vector<std::string> files;
  for (const std::size_t source : sources) {
    files.push_back(source_mask_file(source));
    if (const std::lock_guard lock(mutex_); written_.contains(source)) continue;
    const auto mask = views_.masks[source];
    const std::lock_guard lock(mutex_);
    if (written_.insert(source).second) media::write_png(out_ / files.back(), *mask);
  }
  return files;
}

}  // namespace dvi::result
