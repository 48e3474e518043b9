#include "dvi/media/image_memory.h"

#include "dvi/media/image_file.h"

namespace dvi::media {

std::size_t estimate_image_bytes(const fs::path& folder, const std::vector<std::string>& names, std::size_t bytes_per_pixel) {
  if (names.empty() || !fs::exists(folder / (names.front() + ".png"))) return 0;
  const cv::Size size = image_size(folder / (names.front() + ".png"));
  return bytes_per_pixel * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

}  // namespace dvi::media
