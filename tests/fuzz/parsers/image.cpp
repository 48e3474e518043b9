#include "dvi/media/image_file.h"
#include "parser.h"

// Both as an image and as a mask. Large sizes stay with OpenCV, which takes their memory.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  constexpr std::int64_t kMostPixelsHere = 1 << 16;
  const fs::path file = put(folder / "0.png", bytes);
  const cv::Size size = media::image_size(file);
  if (std::int64_t{size.width} * size.height > kMostPixelsHere) return;
  require(media::read_image(file, size).size() == size, "the image has its size");
  require(media::read_mask(file, size).size() == size, "the mask has its size");
}
