#include "dvi/media/numpy_file.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  require(media::parse_numpy(folder / "0.npy", bytes, {4, 3}).size() == cv::Size(4, 3), "the array has its size");
}
