#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace dvi::registration {

/// Parameters of the check by landmarks.
struct LandmarkParams {
  double cell_m = 0.15;              ///< edge of the grid's cells, and step of the shifts
  double layer_m = 0.4;              ///< height of the grid's cells
  double grid_radius_m = 50;         ///< the grid spans twice this, per axis
  double min_height_m = -1.5;        ///< of the grid, above the ground
  double max_height_m = 10;          ///< of the grid, above the ground
  int max_shift_cells = 10;          ///< 1.5 m: larger than the error after registration, smaller than the distance of posts
  int tolerance_cells = 1;           ///< a landmark that fits best within this shift is an inlier
  int other_place_cells = 4;         ///< a shift by this or more counts as another place
  double block_m = 6;                ///< edge of the square blocks of points that are the landmarks
  double min_point_height_m = 0.25;  ///< above the ground; excludes the road and curbs
  std::size_t min_points = 15;       ///< of a landmark; fewer match by chance
  std::size_t max_points = 400;      ///< of a landmark; more are sampled
  double min_similarity = 0.4;       ///< at the best shift; otherwise the other place does not have the landmark
  double max_self_similarity = 0.6;  ///< of the best similarity, at other shifts in some direction; excludes walls
};
inline constexpr LandmarkParams kLandmarks;

/// How many landmarks of two places agree with their relative pose.
struct LandmarkVotes {
  std::size_t inliers = 0;   ///< landmarks that fit best where they are
  std::size_t outliers = 0;  ///< landmarks that fit better up to 1.5 m away: of another street, or parked cars

  std::size_t total() const { return inliers + outliers; }
  double inlier_ratio() const { return total() > 0 ? static_cast<double>(inliers) / static_cast<double>(total()) : 0; }
};

/// Checks the relative pose of two places. A landmark is a block of 6 m of `b` with a counterpart in `a`; it is shifted by
/// itself in steps of 15 cm up to 1.5 m. Walls and curbs, which look the same everywhere along a street, do not count: a
/// landmark has to fit less than 60 % as well at other shifts. In the right place most landmarks fit best where they are. In a
/// different street that looks alike about one in ten does, by chance. `a` and `b` are upright points in the same level axes.
LandmarkVotes check_landmarks(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

}  // namespace dvi::registration
