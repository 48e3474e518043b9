#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/depth/target.h"
#include "dvi/drive/view.h"
#include "dvi/geometry/se3.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/harmonize.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// A color that a pixel is pulled to, and the weight of the pull relative to that of a pair of neighbors.
struct ColorPull {
  cv::Vec3f color;
  float weight = 0;
};

/// The colors that a frame shows of the ground, by position along and across the road. They continue along the road where
/// nothing was observed: lanes, curbs, and verges are strips.
class RoadColors {
 public:
  /// Reads the ground in the frame of a target: `color` where `known` is not 0.
  RoadColors(const depth::Target& target, const ground::RoadGround& ground, const cv::Mat3f& color, const cv::Mat1b& known);

  /// Returns the color of the strip of ground at a pixel; nothing if the frame does not show the strip.
  std::optional<ColorPull> at(cv::Point p) const;

 private:
  struct Cell {
    cv::Vec3f sum;
    float count = 0;
  };
  struct Position {
    int along, left;    // cell
    double distance_m;  // from the camera
  };

  std::optional<Position> locate(const Eigen::Vector3d& ray, double max_m) const;
  void continue_strips();

  const View& view_;
  const ground::RoadGround& ground_;
  SE3 world_from_camera_;
  std::optional<ground::RoadPlane> plane_;
  double first_m_ = 0;       // along the road, of the first cell
  std::vector<Cell> cells_;  // one row per step along the road
};

/// Returns the pull of the road for each unobserved pixel of the ground in the hole, in the order of candidates.hole; weight 0
/// elsewhere. `color` has the known colors of the frame, and those of copied pixels.
std::vector<ColorPull> pull_along_road(const depth::Target& target, const sample::Candidates& candidates,
                                       const HarmonizeInput& input, const cv::Mat3f& color);

}  // namespace dvi::harmonize
