#include "dvi/align/pair_store.h"

#include <array>
#include <memory>
#include <utility>

namespace dvi::align {
namespace {

/// Distances in frames of compared views, before and after: neighbors, and larger distances that prevent drift.
constexpr std::array<std::size_t, kPartners / 2> kFrameDistances{1, 2, 4, 8, 16, 32};

}  // namespace

std::optional<std::size_t> Partners::get(std::size_t view, std::size_t k) const {
  if (k >= kPartners) {
    if (view >= anchors.size() || k - kPartners >= anchors[view].size()) return std::nullopt;
    return anchors[view][k - kPartners];
  }
  const std::size_t distance = kFrameDistances.at(k / 2);
  if (distance > max_distance) return std::nullopt;
  if (k % 2 == 0) return view < distance ? std::nullopt : std::optional(view - distance);
  return view + distance < count ? std::optional(view + distance) : std::nullopt;
}

void PairStore::add(const std::vector<SharedPoint>& points) {
  for (const SharedPoint& point : points) {
    if (point.observed_by == 0) continue;
    index_.push_back(point.index);
    observed_by_.push_back(point.observed_by);
  }
  first_.push_back(index_.size());
  map_.page_out();
}

std::vector<Pair> PairStore::get_pairs(std::size_t view) const {
  const std::size_t first = first_[view], last = first_[view + 1];
  std::vector<SurfacePoint> surface;
  surface.reserve(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const map::MapPoint& point = map_.points[index_[i]];
    surface.push_back({point.position, point.normal});
  }
  const auto shared = std::make_shared<const std::vector<SurfacePoint>>(std::move(surface));
  std::vector<Pair> out;
  for (std::size_t k = 0; k < kPartners + kAnchors; ++k) {
    const std::optional<std::size_t> partner = partners_.get(view, k);
    if (!partner) continue;
    Pair pair{view, *partner, shared, {}};
    for (std::size_t i = first; i < last; ++i)
      if ((observed_by_[i] >> k & 1) != 0) pair.visible.push_back(static_cast<std::uint32_t>(i - first));
    if (pair.visible.size() >= kMinPairPoints) out.push_back(std::move(pair));
  }
  map_.page_out();
  return out;
}

}  // namespace dvi::align
