#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dvi/align/pair_model.h"
#include "dvi/core/scratch.h"
#include "dvi/map/static_map.h"

namespace dvi::align {

inline constexpr std::size_t kPartners = 8;  ///< most views that one is compared with

/// The k-th view that a view is compared with, if a drive of `count` views has it.
std::optional<std::size_t> partner_of(std::size_t view, std::size_t k, std::size_t count);

/// A map point where a view has texture.
struct SharedPoint {
  std::size_t index = 0;     ///< in StaticMap::points
  std::uint8_t seen_by = 0;  ///< bit k: the view's k-th partner sees it too
};

/// The pairs of all views of a drive, as numbers of map points, within the memory of the map: they would grow with the drive.
class PairStore {
 public:
  /// For a drive of `count` views.
  PairStore(const map::StaticMap& map, std::size_t count)
      : map_(map), count_(count), index_(map.scratch()), seen_by_(map.scratch()) {}

  /// Of the next view.
  void add(const std::vector<SharedPoint>& points);
  /// The pairs whose moving view this is, in the order of partners. Those with too few points are left out.
  std::vector<Pair> of(std::size_t view) const;

 private:
  const map::StaticMap& map_;
  std::size_t count_;
  ScratchVector<std::size_t> index_;
  ScratchVector<std::uint8_t> seen_by_;  // as `index_`
  std::vector<std::size_t> first_{0};    // the points of view i are [first[i], first[i + 1])
};

}  // namespace dvi::align
