#include "dvi/masks/standing.h"

#include <map>
#include <optional>

#include <Eigen/Geometry>

namespace dvi::masks {
namespace {

constexpr double kStill = 1;  // metres

}  // namespace

std::set<int> standing_tracks(const Drive& drive) {
  std::map<int, Eigen::AlignedBox3d> range;
  for (const Frame& frame : drive.frames) {
    const std::optional<SE3> world_from_lidar = drive.poses.at(frame.time_ns);
    for (const Label& label : frame.labels)
      if (label.track >= 0 && label.box && world_from_lidar)
        range[label.track].extend(*world_from_lidar * label.box->frame_from_box.t);
  }
  std::set<int> standing;
  for (const auto& [track, box] : range)
    if (box.diagonal().norm() < kStill) standing.insert(track);
  return standing;
}

void drop_standing(Drive& drive) {
  const std::set<int> standing = standing_tracks(drive);
  drive.labelled = drive.has_labels();  // even if none remains
  for (Frame& frame : drive.frames) std::erase_if(frame.labels, [&](const Label& l) { return standing.contains(l.track); });
}

}  // namespace dvi::masks
