#pragma once

#include <optional>
#include <vector>

#include "dvi/registration/confirm.h"
#include "dvi/registration/key_scans.h"

namespace dvi::registration {

/// How a key scan of one drive lies to one of another.
struct PlaceMatch {
  std::size_t a = 0, b = 0;  ///< key scans
  SE3 a_from_b;              ///< LiDAR axes
  Confirmation things;
  double passed_share = 0;  ///< of what stands for one drive, what the rays of the other went through (seen_through.h)
  double rival = 0;         ///< strength of the second best place, of this one's

  /// What tells the right place from another: more things that agree, and a larger share of them.
  double strength() const { return things.share() * static_cast<double>(things.confirmed); }
  /// Whether single things surely agree more often than by chance, and nowhere else nearly as much.
  bool sure() const;
};

/// A drive that looks for its place, and one in which it may lie: submaps about every 20 m, compared in pairs.
class PlaceFinder {
 public:
  /// A guess of how two places lie to each other.
  struct Start {
    double score = 0;
    std::size_t a = 0, b = 0;  ///< key scans
    SE3 a_from_b;              ///< LiDAR axes
  };

  PlaceFinder(const KeyScans& a, const KeyScans& b);

  /// The best place, sure or not; none where nothing looks alike. With a guess, which may be off by some 10 m and 10 degrees,
  /// only places near it count.
  std::optional<PlaceMatch> find(const std::optional<SE3>& a_world_from_b_world) const;

 private:
  std::vector<Start> starts(const std::optional<SE3>& a_world_from_b_world) const;

  const KeyScans& a_;
  const KeyScans& b_;
};

}  // namespace dvi::registration
