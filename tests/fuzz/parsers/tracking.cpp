#include "dvi/labels/labels.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  labels::read_kitti_tracking(put(folder / "tracking_labels.txt", bytes), {});
}
