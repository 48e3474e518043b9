#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "dvi/odometry/rgbd_image.h"

namespace dvi::odometry {

/// Parameters of the alignment.
struct DirectAlignmentParams {
  std::size_t max_points_per_level = 9000;
  int max_iterations = 15;            ///< per level
  double degrees_of_freedom = 5;      ///< of Student's t-distribution
  double min_gray_noise = 2.5;        ///< lower bound of the scale of gray residuals, in gray levels
  double depth_noise_per_m = 0.0015;  ///< noise of depth over the square of the depth (Khoshelham 2012)
  double min_depth_noise_m = 0.001;
  float min_gradient = 2;            ///< in gray levels per pixel; smaller gradients are noise
  double uniform_gray = 3;           ///< standard deviation in gray levels below which an image counts as uniform
  double max_inlier_sigmas = 5;      ///< distance of an inlier to the surface, in standard deviations of the noise
  double occlusion_tolerance = 0.1;  ///< relative difference in depth
  double max_cost_gray = 15;         ///< gray residual beyond which the cost of a point is constant
  double max_cost_sigmas = 6;        ///< distance beyond which the cost of a point is constant
  double cost_outside = 0.6;         ///< cost of a point outside the image
  double max_step_m = 0.3;           ///< of one iteration
  double max_step_rad = 0.2;         ///< of one iteration
  double converged_px = 0.02;        ///< displacement by the last step
  double prior = 1e-2;               ///< keeps the equations solvable in directions that the scene does not constrain
};

/// An image that others are aligned to: at each level, the points that are compared, with the derivatives of their residuals.
class ReferenceView {
 public:
  struct Point {
    Eigen::Vector3f x;                                     ///< camera axes, meters
    Eigen::Vector3f normal;                                ///< zero if unknown
    float gray = std::numeric_limits<float>::quiet_NaN();  ///< gray level; NaN without color image
    Vector6d by_gray, by_distance;  ///< derivatives of gray level and distance by the point's motion: translation, rotation
  };

  ReferenceView() = default;
  explicit ReferenceView(const RgbdImage& image);

  const std::vector<std::vector<Point>>& levels() const { return levels_; }  ///< finest first, as those of the image

 private:
  std::vector<std::vector<Point>> levels_;
};

/// The pose of an image relative to a reference view, and how well the two agree.
struct Alignment {
  SE3 reference_from_current;
  double gain = 1, offset = 0;  ///< gray level of the current image = gain * reference + offset
  /// Inverse covariance of translation and rotation in the axes of the reference. It is computed on the coarsest level: on
  /// finer levels, noise in gradients and normals seems to constrain the pose. Neighboring pixels are counted as independent,
  /// so it is too large by about the number of pixels that share an error.
  Matrix6d information = Matrix6d::Zero();
  std::size_t points = 0;       ///< of the reference
  std::size_t visible = 0;      ///< of these, within the current image
  std::size_t compared = 0;     ///< of these, with a known depth in the current image
  std::size_t inliers = 0;      ///< of these, on the surface that the current image shows there
  double residual_m = 0;        ///< RMS distance of the inliers to the surfaces
  std::size_t gray_points = 0;  ///< visible points with gray levels in both
  double correlation = 0;       ///< of their gray levels; 1 if both are uniform
  double cost = 0;              ///< mean truncated residual between 0 and 1, comparable between guesses

  double overlap() const { return points > 0 ? static_cast<double>(visible) / static_cast<double>(points) : 0; }
  double inlier_share() const { return compared > 0 ? static_cast<double>(inliers) / static_cast<double>(compared) : 0; }
};

/// The levels of the pyramid on which an alignment runs, from coarse to fine.
struct LevelRange {
  std::size_t coarsest = 3, finest = 0;
};

/// Aligns an image directly to a reference view, so that gray levels and depths agree best. Minimizes photometric
/// residuals and distances to the surfaces of the reference together by Gauss-Newton on SE(3) from coarse to fine (inverse
/// compositional, Baker and Matthews 2004), each weighted by Student's t-distribution with a scale estimated from the
/// residuals, as in Kerl, Sturm and Cremers, "Robust odometry estimation for RGB-D cameras" (ICRA 2013) and "Dense visual SLAM
/// for RGB-D cameras" (IROS 2013). Gain and offset of the gray levels are estimated, too, because cameras expose automatically.
Alignment align(const ReferenceView& reference, const RgbdImage& current, const SE3& reference_from_current,
                const LevelRange& range = {});

}  // namespace dvi::odometry
