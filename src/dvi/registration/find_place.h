#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/registration/key_scans.h"
#include "dvi/registration/landmarks.h"

namespace dvi::registration {

/// Parameters of place recognition. docs/experiments/registration.md has the measurements behind the thresholds.
struct PlaceParams {
  double submap_path_m = 25;            ///< path length of a submap before and after its key scan
  double submap_spacing_m = 20;         ///< path length from one submap to the next
  std::size_t max_queries = 16;         ///< submaps of the drive whose place is searched
  std::size_t max_views = 32;           ///< views that are held in memory at once
  std::size_t candidates_per_pair = 8;  ///< relative poses that one pair of submaps proposes
  std::size_t max_verified = 24;        ///< candidates that are registered and checked
  double max_guess_error_m = 15;        ///< candidates farther from a given guess are dropped
  double max_guess_error_rad = 0.2;     ///< likewise
  double max_pair_distance_m = 60;      ///< submaps farther apart by the guess cannot show the same structures
  double other_place_m = 1;             ///< candidates that differ by more are different places
  double other_place_rad = 0.05;        ///< likewise
  double chance_inlier_ratio = 0.4;     ///< of landmarks in a different street that looks alike
  std::size_t min_inliers = 16;         ///< counted in both directions
  double max_second_best_ratio = 0.6;   ///< of a place that is accepted
  double max_passed_share = 0.25;       ///< twice the share of points that change between days
};
inline constexpr PlaceParams kPlace;

/// The relative pose of a key scan of one drive and a key scan of another.
struct PlaceMatch {
  std::size_t a = 0, b = 0;      ///< indices of the key scans
  SE3 a_from_b;                  ///< LiDAR axes
  LandmarkVotes landmarks;       ///< of both directions
  double passed_share = 0;       ///< share of the upright points of one drive that rays of the other passed (ray_votes.h)
  double second_best_ratio = 0;  ///< score of the second best place, divided by the score of this one

  /// Returns the score that separates the right place from others: it grows with the number and the ratio of inliers.
  double score() const { return landmarks.inlier_ratio() * static_cast<double>(landmarks.inliers); }
  /// Returns whether the landmarks agree more often than by chance, and no other place scores nearly as well.
  bool is_certain() const;
};

/// Finds the place of one drive (b) in another drive (a) by comparing submaps about every 20 m in pairs. Keeps references to
/// the key scans.
class PlaceFinder {
 public:
  /// A hypothesis of the relative pose of two key scans.
  struct Candidate {
    double score = 0;
    std::size_t a = 0, b = 0;  ///< indices of the key scans
    SE3 a_from_b;              ///< LiDAR axes
  };

  PlaceFinder(const KeyScans& a, const KeyScans& b);

  /// Returns the best place, certain or not; nothing if no landmark agrees anywhere. If a guess is given, which may have errors
  /// of about 10 m and 10 degrees, only places near it are considered.
  std::optional<PlaceMatch> find(const std::optional<SE3>& a_world_from_b_world) const;

 private:
  std::vector<Candidate> propose(const std::optional<SE3>& a_world_from_b_world) const;

  const KeyScans& a_;
  const KeyScans& b_;
};

}  // namespace dvi::registration
