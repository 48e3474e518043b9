#include "dvi/datasets/rgbd.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  datasets::read_pose_matrix(put(folder / "pose.txt", bytes));
}
