#include "dvi/datasets/reader.h"
#include "parser.h"

// The times of both sensors, whose clocks are shifted as far as they may be.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  put_two_frames(folder / "images/front", folder / "lidar");
  put(folder / "dvi.toml",
      "[camera.front]\nK = [8, 0, 4, 0, 8, 3, 0, 0, 1]\ncamera_from_lidar = [0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0]\n"
      "offset_s = 4.9e8\n[lidar]\noffset_s = -4.9e8\n");
  const std::size_t half = bytes.find("\n\n");
  put(folder / "times/front.txt", bytes.substr(0, half));
  put(folder / "times/lidar.txt", half == std::string::npos ? "1 1.0\n2 1.1\n" : bytes.substr(half + 2));
  datasets::read_drive(folder);
}
