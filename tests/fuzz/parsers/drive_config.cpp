#include "dvi/datasets/reader.h"
#include "parser.h"

// dvi.toml of a drive whose clocks are as far apart as times may be.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  put_two_frames(folder / "images/front", folder / "lidar");
  put(folder / "times/front.txt", "1 3999999999.9\n2 4000000000\n");
  put(folder / "times/lidar.txt", "1 -4000000000\n2 -3999999999.9\n");
  put(folder / "dvi.toml", bytes);
  datasets::read_drive(folder);
}
