#include "dvi/objects/completion/labeled_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include "dvi/core/median.h"
#include "dvi/objects/motion.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct LabeledBoxParams {
  std::size_t min_boxes = 2;       ///< frames that confirm an object
  double max_gap_s = 1;            ///< between the boxes of a moving object
  double inner_share = 0.8;        ///< of a box, which its object fills
  double judged_radius_m = 0.05;   ///< radius around a point that a scan must pass
  double min_passed_share = 0.5;   ///< of the judged points in the box of an absent object; rays pass windows
  double min_hidden_share = 0.8;   ///< of the points in front of a hidden object
  double clearance_m = 0.5;        ///< distance of these points from the box
  std::size_t min_stationary = 4;  ///< boxes of an object that stays in place ...
  double max_spread_m = 1.5;       ///< ... and the diagonal of the box of their positions
};
constexpr LabeledBoxParams kLabeledBox;

// Points in a box, as multiples of its half size.
constexpr std::array kGrid{-1.0, -0.33, 0.33, 1.0};

Box interpolate(const Box& a, const Box& b, double share) {
  Box out = a;
  out.frame_from_box.t += share * (b.frame_from_box.t - a.frame_from_box.t);
  return out;
}

}  // namespace

std::map<int, std::size_t> find_repeated_tracks(const FrameLabels& labels) {
  std::map<int, std::size_t> repeated;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    std::set<int> tracks;
    for (const Label& label : labels[i])
      if (label.track >= 0 && label.box && !tracks.insert(label.track).second) repeated.try_emplace(label.track, i);
  }
  return repeated;
}

std::vector<LabeledBoxes> LabeledBoxes::collect(const Drive& drive, const FrameLabels& labels,
                                                const Trajectory& world_from_lidar) {
  const std::map<int, std::size_t> repeated = find_repeated_tracks(labels);
  std::map<int, LabeledBoxes> tracks;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const std::int64_t time_ns = drive.frames[i].time_ns;
    const std::optional<SE3> pose = world_from_lidar.at(time_ns);
    if (!pose) continue;
    for (const Label& label : labels[i]) {
      if (label.track < 0 || !label.box || repeated.contains(label.track)) continue;
      LabeledBoxes& track = tracks[label.track];
      track.track_ = label.track;
      track.type_ = label.type;
      track.boxes_.push_back({time_ns, {*pose * label.box->frame_from_box, label.box->size}});
    }
  }
  for (const TrackMotion& motion : measure_track_motions(drive, labels, world_from_lidar))
    if (const auto track = tracks.find(motion.track); track != tracks.end()) track->second.moves_ = motion.moves;
  std::vector<LabeledBoxes> out;
  for (auto& [number, track] : tracks)
    if (track.boxes_.size() >= kLabeledBox.min_boxes) out.push_back(std::move(track));
  return out;
}

std::optional<Box> LabeledBoxes::at(std::int64_t time_ns) const {
  const auto after =
      std::partition_point(boxes_.begin(), boxes_.end(), [&](const StampedBox& box) { return box.time_ns < time_ns; });
  if (after != boxes_.end() && after->time_ns == time_ns) return after->world;
  if (after == boxes_.begin()) return moves_ ? std::nullopt : std::optional(after->world);
  const auto before = std::prev(after);
  if (after == boxes_.end()) return moves_ ? std::nullopt : std::optional(before->world);
  const double gap_s = seconds_between(before->time_ns, after->time_ns), since_s = seconds_between(before->time_ns, time_ns);
  if (!moves_) return (since_s < 0.5 * gap_s ? before : after)->world;
  if (gap_s > kLabeledBox.max_gap_s) return std::nullopt;
  return interpolate(before->world, after->world, since_s / gap_s);
}

std::optional<Box> LabeledBoxes::find_stationary_box() const {
  if (moves_ || boxes_.size() < kLabeledBox.min_stationary) return std::nullopt;
  Eigen::AlignedBox3d positions;
  for (const StampedBox& box : boxes_) positions.extend(box.world.frame_from_box.t);
  if (positions.diagonal().norm() > kLabeledBox.max_spread_m) return std::nullopt;
  Eigen::Vector3d position, size;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> coordinates, lengths;
    for (const StampedBox& box : boxes_) {
      coordinates.push_back(box.world.frame_from_box.t[axis]);
      lengths.push_back(box.world.size[axis]);
    }
    position[axis] = median(std::move(coordinates)), size[axis] = median(std::move(lengths));
  }
  const auto middle = std::min_element(boxes_.begin(), boxes_.end(), [&](const StampedBox& a, const StampedBox& b) {
    return (a.world.frame_from_box.t - position).norm() < (b.world.frame_from_box.t - position).norm();
  });
  return Box{{middle->world.frame_from_box.R, position}, size};
}

bool is_absent_or_hidden(const Box& world, const FreeSpace& scan) {
  if (!scan.valid()) return false;
  int points = 0, judged = 0, passed = 0, hidden = 0;
  for (const double x : kGrid)
    for (const double y : kGrid)
      for (const double z : kGrid) {
        const Eigen::Vector3d inner = 0.5 * kLabeledBox.inner_share * world.size.cwiseProduct(Eigen::Vector3d(x, y, z));
        const Eigen::Vector3d point = world.frame_from_box * inner;
        const FreeSpace::Seen seen = scan.judge(point, kLabeledBox.judged_radius_m);
        judged += seen != FreeSpace::Seen::unknown;
        passed += seen == FreeSpace::Seen::passed;
        const Eigen::Vector3d to_sensor = (scan.sensor() - point).normalized();
        const Eigen::Vector3d front = point + (world.size.head<2>().norm() + kLabeledBox.clearance_m) * to_sensor;
        hidden += scan.judge(front, kLabeledBox.judged_radius_m) == FreeSpace::Seen::hidden;
        ++points;
      }
  return (judged > 0 && passed >= kLabeledBox.min_passed_share * judged) || hidden >= kLabeledBox.min_hidden_share * points;
}

}  // namespace dvi::objects
