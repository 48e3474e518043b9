#include "dvi/media/image_memory.h"

#include <algorithm>

#include "dvi/core/frame_name.h"
#include "dvi/media/image_file.h"

namespace dvi::media {

std::size_t estimate_image_bytes(const fs::path& out, const std::string& folder, const std::vector<std::string>& frames,
                                 std::size_t bytes_per_pixel) {
  std::size_t largest = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i > 0 && camera_of_frame(frames[i]) == camera_of_frame(frames[i - 1])) continue;
    if (const fs::path file = out / picture_file(folder, frames[i]); fs::exists(file)) {
      const cv::Size size = image_size(file);
      largest = std::max(largest, static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
    }
  }
  return bytes_per_pixel * largest;
}

}  // namespace dvi::media
