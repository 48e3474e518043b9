#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"
#include "dvi/map/static_map.h"

namespace dvi::report {

/// The positions of a removed object.
struct ObjectPath {
  int number = -1;
  std::string type;
  std::vector<Eigen::Vector2d> points;  ///< meters, in the world
  std::vector<std::size_t> frames;      ///< per point: index of the target's posed frame
};

/// The input of the view of the drive from above.
struct TopView {
  const map::StaticMap& map;
  std::function<cv::Vec3b(std::size_t point)> color;  ///< BGR of a map point
  Camera camera;
  std::vector<SE3> world_from_camera;  ///< of the target's frames
  std::vector<ObjectPath> tracks;
};

/// Writes FOLDER/map.png, the static map in its colors with removed points in red, x of the world to the right and y up, and
/// FOLDER/above.json, which has the position of this image, the camera, its poses, and the tracks.
void write_top_view(const fs::path& folder, const TopView& view);

}  // namespace dvi::report
