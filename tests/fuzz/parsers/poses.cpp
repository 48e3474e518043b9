#include "dvi/datasets/pose_file.h"
#include "parser.h"

void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  Drive drive;
  drive.frames = {{0, "0", 0, {}, {}}, {1, "1", 100'000'000, {}, {}}};
  drive.scan_headers = {{"0", 0, -50'000'000, 50'000'000, {}}, {"1", 100'000'000, 50'000'000, 150'000'000, {}}};
  const Trajectory poses = datasets::read_poses(put(folder / "poses.txt", bytes), drive);
  for (const Frame& frame : drive.frames) poses.at(frame.time_ns);
}
