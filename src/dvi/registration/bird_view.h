#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/geometry/se3.h"
#include "dvi/scan_match/features.h"

namespace dvi::registration {

/// The ground about the sensor made level: z = 0 is the ground, z up, x forward. Whatever the mounting of the sensor, two
/// vehicles on one road then differ by a position and a heading. The identity where no ground is seen.
SE3 level_from_lidar(const std::vector<scan_match::Feature>& planes);

/// What stands on the ground (walls, poles, trees): the points of columns of half a meter that reach higher than a curb.
/// Level axes.
std::vector<Eigen::Vector3d> standing_points(const std::vector<scan_match::Feature>& points, const SE3& level_from_lidar);

/// What stands round a place, seen from above, as a spectrum: made once, compared often.
struct BirdView {
  cv::Mat2f spectrum;
};

/// One place as seen in all headings. 47 MB.
struct TurnedViews {
  std::vector<cv::Mat2f> spectra;  ///< one a heading, evenly spread over half the circle
};

BirdView bird_view(const std::vector<Eigen::Vector3d>& standing);
TurnedViews turned_views(const std::vector<Eigen::Vector3d>& standing);

/// A guess of how two places lie to each other.
struct PlacementGuess {
  double score = 0;  ///< correlation of the views; comparable between pairs
  SE3 a_from_b;      ///< level axes
};

/// Where a place lies in the other by correlation of whitened views over all headings and positions up to 50 m, as in phase
/// correlation (Kuglin and Hines 1975): what stands alone counts more than long walls. The best `count` that are apart from
/// each other.
std::vector<PlacementGuess> correlate(const BirdView& a, const TurnedViews& b, std::size_t count);

}  // namespace dvi::registration
