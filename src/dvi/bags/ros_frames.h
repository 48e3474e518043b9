#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/bags/ros_message.h"
#include "dvi/geometry/trajectory.h"

namespace dvi::bags {

/// The tree of frames described by tf messages: each frame has a parent.
class RosFrames {
 public:
  void add(const RosMotion& motion, bool is_static);

  /// Returns target_from_source between frames that are stationary relative to each other; nothing if they are not connected.
  std::optional<SE3> find_transform(const std::string& target, const std::string& source) const;

  /// Returns the motion of a frame relative to the topmost frame above it; an empty trajectory if it does not move.
  Trajectory find_motion(const std::string& frame) const;

 private:
  struct Edge {
    std::string parent;
    std::vector<StampedPose> poses;  // parent_from_child
    bool is_static = false;
  };
  // Returns whether the poses of an edge are constant, since some publishers repeat static transforms.
  static bool is_constant(const Edge& edge);
  std::pair<std::string, SE3> find_root(std::string frame) const;

  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace dvi::bags
