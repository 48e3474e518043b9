#include "dvi/media/image_memory.h"

#include "dvi/media/image_file.h"

namespace dvi::media {

std::size_t estimate_image_bytes(const fs::path& file, std::size_t bytes_per_pixel) {
  if (!fs::exists(file)) return 0;
  const cv::Size size = image_size(file);
  return bytes_per_pixel * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

}  // namespace dvi::media
