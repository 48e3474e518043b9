#include "dvi/bags/ros_frames.h"

#include <algorithm>

namespace dvi::bags {
namespace {

constexpr std::size_t kDeepest = 100;  // frames above each other; a ring of them would never end

}  // namespace

void RosFrames::add(const RosMotion& motion, bool is_static) {
  Edge& edge = edges_[motion.child];
  edge.parent = motion.header.frame;
  edge.is_static = edge.is_static || is_static;
  edge.poses.push_back({motion.header.stamp_ns, motion.parent_from_child});
}

bool RosFrames::constant(const Edge& edge) {
  constexpr double kStill = 1e-9;
  const SE3& first = edge.poses.front().world_from_body;
  return edge.is_static || std::all_of(edge.poses.begin(), edge.poses.end(), [&](const StampedPose& pose) {
           return (pose.world_from_body.t - first.t).norm() < kStill && (pose.world_from_body.R - first.R).norm() < kStill;
         });
}

// The topmost frame that a frame stands still in, and root_from_frame.
std::pair<std::string, SE3> RosFrames::root_of(std::string frame) const {
  SE3 root_from_frame;
  for (std::size_t steps = 0; steps < kDeepest; ++steps) {
    const auto edge = edges_.find(frame);
    if (edge == edges_.end() || !constant(edge->second)) break;
    root_from_frame = edge->second.poses.back().world_from_body * root_from_frame;
    frame = edge->second.parent;
  }
  return {frame, root_from_frame};
}

std::optional<SE3> RosFrames::between(const std::string& target, const std::string& source) const {
  if (target == source) return SE3();
  const auto [a, root_from_target] = root_of(target);
  const auto [b, root_from_source] = root_of(source);
  if (a != b) return std::nullopt;
  return root_from_target.inverse() * root_from_source;
}

Trajectory RosFrames::motion_of(const std::string& frame) const {
  auto [name, root_from_frame] = root_of(frame);
  std::vector<StampedPose> poses;
  for (std::size_t steps = 0; steps < kDeepest; ++steps) {
    const auto edge = edges_.find(name);
    if (edge == edges_.end()) break;
    const Edge& next = edge->second;
    if (steps == 0) {  // the lowest moving frame tells the times
      for (const StampedPose& pose : next.poses) poses.push_back({pose.time_ns, pose.world_from_body * root_from_frame});
    } else if (constant(next)) {
      for (StampedPose& pose : poses) pose.world_from_body = next.poses.back().world_from_body * pose.world_from_body;
    } else {
      Trajectory above(next.poses);
      std::vector<StampedPose> joined;
      for (const StampedPose& pose : poses)
        if (const auto there = above.at(pose.time_ns)) joined.push_back({pose.time_ns, *there * pose.world_from_body});
      poses = std::move(joined);
    }
    name = next.parent;
  }
  return Trajectory(std::move(poses));
}

}  // namespace dvi::bags
