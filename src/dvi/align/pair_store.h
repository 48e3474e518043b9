#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/align/pair_model.h"
#include "dvi/core/scratch.h"
#include "dvi/map/static_map.h"

namespace dvi::align {

inline constexpr std::size_t kPartners = 12;  ///< largest number of views of the same sequence that a view is compared with
inline constexpr std::size_t kAnchors = 4;    ///< likewise, of sequences that are already aligned

/// The views that each view of a sequence is compared with. Views are numbered from 0, followed by their anchors, which are
/// views of sequences that are already aligned.
struct Partners {
  std::size_t count = 0;                            ///< views of the sequence
  std::vector<std::vector<std::size_t>> anchors{};  ///< per view, at most kAnchors each; may be empty
  std::size_t max_distance = 8;                     ///< largest distance in frames of compared views; up to 32

  /// Returns the k-th partner of a view, k < kPartners + kAnchors, if there is one.
  std::optional<std::size_t> get(std::size_t view, std::size_t k) const;
};

/// A map point at which a view has texture.
struct SharedPoint {
  std::size_t index = 0;          ///< in StaticMap::points
  std::uint16_t observed_by = 0;  ///< bit k: the view's k-th partner shows it, too
};

/// The pairs of all views of a drive, stored as indices of map points in the scratch memory of the map, because they grow with
/// the drive.
class PairStore {
 public:
  PairStore(const map::StaticMap& map, Partners partners)
      : map_(map), partners_(std::move(partners)), index_(map.scratch()), observed_by_(map.scratch()) {}

  const Partners& partners() const { return partners_; }
  /// Adds the points of the next view.
  void add(const std::vector<SharedPoint>& points);
  /// Returns the pairs with this moving view, in the order of partners, without those with too few points.
  std::vector<Pair> get_pairs(std::size_t view) const;

 private:
  const map::StaticMap& map_;
  Partners partners_;
  ScratchVector<std::size_t> index_;
  ScratchVector<std::uint16_t> observed_by_;  // one per entry of `index_`
  std::vector<std::size_t> first_{0};         // the points of view i are [first[i], first[i + 1])
};

}  // namespace dvi::align
