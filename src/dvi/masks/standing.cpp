#include "dvi/masks/standing.h"

#include <map>
#include <optional>

#include <Eigen/Geometry>

namespace dvi::masks {
namespace {

constexpr double kStill = 1;  // metres

}  // namespace

std::set<int> standing_tracks(const Drive& drive, const Trajectory& world_from_lidar) {
  std::map<int, Eigen::AlignedBox3d> range;
  for (const Frame& frame : drive.frames) {
    const std::optional<SE3> pose = world_from_lidar.at(frame.time_ns);
    for (const Label& label : frame.labels)
      if (label.track >= 0 && label.box && pose) range[label.track].extend(*pose * label.box->frame_from_box.t);
  }
  std::set<int> standing;
  for (const auto& [track, box] : range)
    if (box.diagonal().norm() < kStill) standing.insert(track);
  return standing;
}

FrameLabels without_standing(const Drive& drive, const Trajectory& world_from_lidar) {
  const std::set<int> standing = standing_tracks(drive, world_from_lidar);
  FrameLabels labels = drive.labels();
  for (std::vector<Label>& frame : labels) std::erase_if(frame, [&](const Label& l) { return standing.contains(l.track); });
  return labels;
}

}  // namespace dvi::masks
