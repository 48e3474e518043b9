#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The part of space that an object fills in one frame, as columns on the ground, world axes.
class ObjectColumns {
 public:
  /// Extends a column up to a point and half of its height.
  void add(const Eigen::Vector3d& point, double half_height_m);

  /// Adds other columns.
  void add(const ObjectColumns& other);

  bool empty() const { return tops_m_.empty(); }
  /// Returns the height of the highest column within a number of columns around a position; nothing if there is none.
  std::optional<double> top_near(const Eigen::Vector2d& position, int columns) const;
  /// Draws the columns, each from the ground to its top, and closes the gaps between them.
  cv::Mat1b draw(const ground::ScanGround& ground, const Camera& camera, const SE3& camera_from_world) const;
  /// Returns the depth of the nearest column in a camera, in meters.
  double nearest_m(const Camera& camera, const SE3& camera_from_world) const;

 private:
  std::map<std::pair<int, int>, double> tops_m_;  // height of the top
};

/// Returns the columns of a track at a time: the returns of the nearest scan, moved along the track; none if that scan is more
/// than a quarter of a second away.
ObjectColumns fill_columns(const Track& track, std::int64_t time_ns);

}  // namespace dvi::objects
