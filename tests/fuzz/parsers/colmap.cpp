#include "dvi/datasets/colmap_model.h"
#include "parser.h"

// The first byte says which file of a model the others are: u, v, t cameras, images, points as text; B, C, D binary.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const std::string rest = bytes.empty() ? "" : bytes.substr(1);
  const bool text = !bytes.empty() && bytes[0] >= 't';
  const int which = bytes.empty() ? 0 : bytes[0] % 3;
  const std::string ending = text ? ".txt" : ".bin";
  for (const char* stale : {"cameras.bin", "images.bin"}) fs::remove(folder / stale);
  put(folder / "cameras.txt", "1 PINHOLE 8 6 4 5 4.5 3.5\n");
  put(folder / "images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n");
  if (which == 2)
    dvi::datasets::read_colmap_points(put(folder / ("points3D" + ending), rest));
  else {
    put(folder / ((which == 0 ? "cameras" : "images") + ending), rest);
    dvi::datasets::read_colmap_model(folder);
  }
}
