#include "dvi/bags/ros_frames.h"

#include <algorithm>

namespace dvi::bags {
namespace {

constexpr std::size_t kMaxDepth = 100;  // depth of the tree; stops at cycles

}  // namespace

void RosFrames::add(const RosMotion& motion, bool is_static) {
  Edge& edge = edges_[motion.child];
  edge.parent = motion.header.frame;
  edge.is_static = edge.is_static || is_static;
  edge.poses.push_back({motion.header.stamp_ns, motion.parent_from_child});
}

bool RosFrames::is_constant(const Edge& edge) {
  constexpr double kMaxMotion = 1e-9;
  const SE3& first = edge.poses.front().world_from_body;
  return edge.is_static || std::all_of(edge.poses.begin(), edge.poses.end(), [&](const StampedPose& pose) {
           return (pose.world_from_body.t - first.t).norm() < kMaxMotion &&
                  (pose.world_from_body.R - first.R).norm() < kMaxMotion;
         });
}

// Returns the topmost frame relative to which a frame is stationary, and root_from_frame.
std::pair<std::string, SE3> RosFrames::find_root(std::string frame) const {
  SE3 root_from_frame;
  for (std::size_t steps = 0; steps < kMaxDepth; ++steps) {
    const auto edge = edges_.find(frame);
    if (edge == edges_.end() || !is_constant(edge->second)) break;
    root_from_frame = edge->second.poses.back().world_from_body * root_from_frame;
    frame = edge->second.parent;
  }
  return {frame, root_from_frame};
}

std::optional<SE3> RosFrames::find_transform(const std::string& target, const std::string& source) const {
  if (target == source) return SE3();
  const auto [a, root_from_target] = find_root(target);
  const auto [b, root_from_source] = find_root(source);
  if (a != b) return std::nullopt;
  return root_from_target.inverse() * root_from_source;
}

Trajectory RosFrames::find_motion(const std::string& frame) const {
  auto [name, root_from_frame] = find_root(frame);
  std::vector<StampedPose> poses;
  for (std::size_t steps = 0; steps < kMaxDepth; ++steps) {
    const auto edge = edges_.find(name);
    if (edge == edges_.end()) break;
    const Edge& next = edge->second;
    if (steps == 0) {  // the lowest moving frame determines the times
      for (const StampedPose& pose : next.poses) poses.push_back({pose.time_ns, pose.world_from_body * root_from_frame});
    } else if (is_constant(next)) {
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
