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

/// Where an object that was removed has been.
struct ObjectPath {
  int number = -1;
  std::string type;
  std::vector<Eigen::Vector2d> points;  ///< meters, world axes
  std::vector<std::size_t> frames;      ///< as `points`: indices of posed frames of the target
};

/// The drive from above: FOLDER/map.png, the static map in its colors with what was removed in red, north up where x is east,
/// and FOLDER/above.json: where that picture lies, the camera, its poses and the tracks.
struct Above {
  const map::StaticMap& map;
  std::function<cv::Vec3b(std::size_t point)> color;  ///< BGR, of a point of the map
  Camera camera;
  std::vector<SE3> world_from_camera;  ///< of the target's frames
  std::vector<ObjectPath> tracks;
};
void write_above(const fs::path& folder, const Above& above);

}  // namespace dvi::report
