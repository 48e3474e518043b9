#include "dvi/align/pair_store.h"

#include <array>
#include <memory>
#include <utility>

namespace dvi::align {
namespace {

// Frames that are compared: neighbors, and some farther apart that keep the chain from drifting; before and after.
constexpr std::array<std::size_t, kPartners / 2> kApart{1, 2, 4, 8, 16, 32};

}  // namespace

std::optional<std::size_t> Partners::of(std::size_t view, std::size_t k) const {
  if (k >= kPartners) {
    if (view >= anchors.size() || k - kPartners >= anchors[view].size()) return std::nullopt;
    return anchors[view][k - kPartners];
  }
  const std::size_t apart = kApart.at(k / 2);
  if (apart > farthest) return std::nullopt;
  if (k % 2 == 0) return view < apart ? std::nullopt : std::optional(view - apart);
  return view + apart < count ? std::optional(view + apart) : std::nullopt;
}

void PairStore::add(const std::vector<SharedPoint>& points) {
  for (const SharedPoint& point : points) {
    if (point.seen_by == 0) continue;
    index_.push_back(point.index);
    seen_by_.push_back(point.seen_by);
  }
  first_.push_back(index_.size());
  map_.page_out();
}

std::vector<Pair> PairStore::of(std::size_t view) const {
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
    const std::optional<std::size_t> partner = partners_.of(view, k);
    if (!partner) continue;
    Pair pair{view, *partner, shared, {}};
    for (std::size_t i = first; i < last; ++i)
      if ((seen_by_[i] >> k & 1) != 0) pair.seen.push_back(static_cast<std::uint32_t>(i - first));
    if (pair.seen.size() >= kFewestPoints) out.push_back(std::move(pair));
  }
  map_.page_out();
  return out;
}

}  // namespace dvi::align
