#include "dvi/inputs/near_target.h"

#include <cmath>
#include <set>
#include <utility>

namespace dvi::inputs {
namespace {

constexpr double kCell = 50;  // meters

using Cell = std::pair<int, int>;

Cell cell_of(const Eigen::Vector3d& position) {
  return {static_cast<int>(std::floor(position.x() / kCell)), static_cast<int>(std::floor(position.y() / kCell))};
}

// Every cell that may hold a position within kFarApart of where the drive took its frames.
std::set<Cell> cells_round(const Drive& drive) {
  constexpr int kReach = static_cast<int>(kFarApart / kCell);
  std::set<Cell> of_path, out;
  for (const Frame& frame : drive.frames)
    if (const auto pose = drive.poses.at(frame.time_ns)) of_path.insert(cell_of(pose->t));
  for (const auto& [x, y] : of_path)
    for (int dx = -kReach; dx <= kReach; ++dx)
      for (int dy = -kReach; dy <= kReach; ++dy) out.insert({x + dx, y + dy});
  return out;
}

}  // namespace

std::optional<TimeSpan> time_near_target(const Drive& target, const Drive& source) {
  const std::set<Cell> near = cells_round(target);
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
