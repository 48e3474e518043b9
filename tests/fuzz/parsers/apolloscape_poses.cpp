#include "dvi/datasets/reader.h"
#include "parser.h"

// global_poses.txt and rel_poses.txt, which follows an empty line. The first bytes of an image determine its format.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  if (!fs::exists(folder / "image")) {
    put_two_frames(folder / "image", folder / "lidar_bg");
    for (const std::string name : {"1", "2"}) {
      fs::rename(folder / "image" / (name + ".png"), folder / "image" / (name + ".jpg"));
      fs::rename(folder / "lidar_bg" / (name + ".bin"), folder / "lidar_bg" / (name + ".ply"));
    }
  }
  const std::size_t half = bytes.find("\n\n");
  put(folder / "1-2/global_poses.txt", bytes.substr(0, half));
  put(folder / "1-2/rel_poses.txt", half == std::string::npos ? "" : bytes.substr(half + 2));
  datasets::read_drive(folder);
}
