#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/bags/ros_message.h"
#include "dvi/geometry/trajectory.h"

namespace dvi::bags {

/// The tree of frames that tf messages tell: each frame has a parent.
class RosFrames {
 public:
  void add(const RosMotion& motion, bool is_static);

  /// target_from_source between frames that do not move against each other; none where nothing joins them.
  std::optional<SE3> between(const std::string& target, const std::string& source) const;

  /// The motion of a frame against the topmost frame above it; empty where it does not move.
  Trajectory motion_of(const std::string& frame) const;

 private:
  struct Edge {
    std::string parent;
    std::vector<StampedPose> poses;  // parent_from_child
    bool is_static = false;
  };
  // Also of publishers that repeat what never changes.
  static bool constant(const Edge& edge);
  std::pair<std::string, SE3> root_of(std::string frame) const;

  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace dvi::bags
