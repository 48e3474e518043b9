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

inline constexpr std::size_t kPartners = 12;  ///< most views of its own sequence that one is compared with
inline constexpr std::size_t kAnchors = 4;    ///< and of sequences that are aligned already

/// Which views each view of a sequence is compared with. They are numbered from 0; behind them come their anchors, views of
/// sequences that are aligned already.
struct Partners {
  std::size_t count = 0;                            ///< views of the sequence
  std::vector<std::vector<std::size_t>> anchors{};  ///< by view, at most kAnchors each; empty: none
  std::size_t farthest = 8;                         ///< frames between two that are compared; up to 32

  /// The k-th one, k < kPartners + kAnchors, if there is one.
  std::optional<std::size_t> of(std::size_t view, std::size_t k) const;
};

/// A map point where a view has texture.
struct SharedPoint {
  std::size_t index = 0;      ///< in StaticMap::points
  std::uint16_t seen_by = 0;  ///< bit k: the view's k-th partner sees it too
};

/// The pairs of all views of a drive, as numbers of map points, within the memory of the map: they would grow with the drive.
class PairStore {
 public:
  PairStore(const map::StaticMap& map, Partners partners)
      : map_(map), partners_(std::move(partners)), index_(map.scratch()), seen_by_(map.scratch()) {}

  const Partners& partners() const { return partners_; }
  /// Of the next view.
  void add(const std::vector<SharedPoint>& points);
  /// The pairs whose moving view this is, in the order of partners. Those with too few points are left out.
  std::vector<Pair> of(std::size_t view) const;

 private:
  const map::StaticMap& map_;
  Partners partners_;
  ScratchVector<std::size_t> index_;
  ScratchVector<std::uint16_t> seen_by_;  // as `index_`
  std::vector<std::size_t> first_{0};     // the points of view i are [first[i], first[i + 1])
};

}  // namespace dvi::align
