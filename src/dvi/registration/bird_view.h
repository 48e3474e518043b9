#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/geometry/se3.h"
#include "dvi/scan_match/features.h"

namespace dvi::registration {

/// Parameters of the ground plane below a sensor.
struct GroundPlaneParams {
  double max_range_m = 20;      ///< horizontal; a road is flat only near the sensor
  double voxel_m = 1.5;         ///< edge of the voxels whose shapes are the samples of the ground
  double min_normal_z = 0.85;   ///< of a sample; includes slopes and tilted mountings, excludes walls
  double max_distance_m = 0.3;  ///< final scale of the robust kernel; the first iteration uses 2 m
};
inline constexpr GroundPlaneParams kGroundPlane;

/// Parameters of the views from above and of their correlation.
struct BirdViewParams {
  double radius_m = 45;              ///< points that are farther from the center are left out
  double cell_m = 0.5;               ///< edge of the columns of points and of the cells of the view
  double min_column_height_m = 0.6;  ///< higher than a curb
  double max_height_m = 10;          ///< above the ground
  int size_cells = 256;              ///< of the view; more than twice the radius, so that shifts do not wrap around
  int headings = 180;                ///< of the full circle, evenly spaced
  int peaks_per_heading = 6;         ///< candidates that are kept for each heading
  double max_shift_m = 50;           ///< largest distance between the two places, per axis
  double whitening = 0.7;            ///< exponent; 0 is plain correlation, 1 is phase correlation
  double min_peak_distance_m = 1.5;  ///< half the distance between two candidates of similar heading
  int min_heading_difference = 4;    ///< candidates whose headings differ by more steps than this are always distinct
};
inline constexpr BirdViewParams kBirdView;

/// Estimates the transform that levels a scan: z = 0 is the ground, z points up, x forward. Two vehicles on the same road then
/// differ by a position and a heading, whatever the mounting of their sensors. Returns the identity if no ground is visible.
/// `planes` are the planar features of a scan in LiDAR axes.
SE3 level_from_lidar(const std::vector<scan_match::Feature>& planes);

/// Returns the points of upright structures (walls, poles, trees) in level axes: the points of all columns that are higher than
/// a curb. `points` are in LiDAR axes.
std::vector<Eigen::Vector3d> extract_upright_points(const std::vector<scan_match::Feature>& points,
                                                    const SE3& level_from_lidar);

/// The upright structures around a place in a view from above, as a whitened spectrum.
struct BirdView {
  cv::Mat2f spectrum;
};

/// One place in all headings. Takes 47 MB.
struct RotatedViews {
  std::vector<cv::Mat2f> spectra;  ///< one per heading, evenly spaced over half the circle
};

/// These two expect upright points in level axes.
BirdView make_bird_view(const std::vector<Eigen::Vector3d>& upright);
RotatedViews make_rotated_views(const std::vector<Eigen::Vector3d>& upright);

/// A hypothesis of the relative pose of two places.
struct PlacementGuess {
  double score = 0;  ///< correlation of the views; comparable between pairs of places
  SE3 a_from_b;      ///< level axes
};

/// Finds the relative poses of two places by correlation of their whitened views over all headings and shifts up to
/// BirdViewParams::max_shift_m, as in phase correlation (Kuglin and Hines 1975), which weights isolated structures more than
/// long walls. Returns at most `count` distinct poses, the best first.
std::vector<PlacementGuess> correlate(const BirdView& a, const RotatedViews& b, std::size_t count);

}  // namespace dvi::registration
