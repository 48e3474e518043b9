#include "dvi/inputs/near_target.h"

#include <cmath>
#include <set>
#include <utility>

namespace dvi::inputs {
namespace {

constexpr double kCellM = 50;

using Cell = std::pair<int, int>;

Cell cell_of(const Eigen::Vector3d& position) {
  return {static_cast<int>(std::floor(position.x() / kCellM)), static_cast<int>(std::floor(position.y() / kCellM))};
}

/// Returns every cell that may contain a position within kMaxSharedViewM of a frame's position.
std::set<Cell> cells_around(const Drive& drive) {
  constexpr int kMaxCells = static_cast<int>(kMaxSharedViewM / kCellM);
  std::set<Cell> of_path, out;
  for (const Frame& frame : drive.frames)
    if (const auto pose = drive.poses.at(frame.time_ns)) of_path.insert(cell_of(pose->t));
  for (const auto& [x, y] : of_path)
    for (int dx = -kMaxCells; dx <= kMaxCells; ++dx)
      for (int dy = -kMaxCells; dy <= kMaxCells; ++dy) out.insert({x + dx, y + dy});
  return out;
}

}  // namespace

std::optional<TimeSpan> time_near_target(const Drive& target, const Drive& source) {
  const std::set<Cell> near = cells_around(target);
  const double scale = target.world_scale / source.world_scale;
  std::optional<TimeSpan> out;
  for (const StampedPose& pose : source.poses.poses()) {
    if (!near.contains(cell_of(scale * pose.world_from_body.t))) continue;
    if (!out) out = TimeSpan{pose.time_ns, pose.time_ns};
    out->last = pose.time_ns;
  }
  return out;
}

}  // namespace dvi::inputs
