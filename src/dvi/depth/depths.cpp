#include "dvi/depth/depths.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "dvi/core/work_memory.h"
#include "dvi/depth/occluders.h"
#include "dvi/depth/packed_depth.h"

namespace dvi::depth {
namespace {

/// Parameters of the store of packed depth maps.
struct PackedDepthParams {
  std::size_t max_bytes = std::size_t{192} << 20;  ///< Memory of all packed depth maps together, ...
  std::size_t work_memory_divisor = 4;             ///< ... and at most this part of the memory for work in progress.
};
constexpr PackedDepthParams kPackedDepth;

/// Packed depth maps of views that will be targets later.
class PackedDepths {
 public:
  /// States that the depth map of a view is needed now: put() stores it beyond the bound.
  void expect(std::size_t view) {
    const std::lock_guard lock(mutex_);
    expected_.insert(view);
  }
  /// Stores a depth map. If the bound is reached, the depth maps of the last views are dropped, which are needed last.
  void put(std::size_t view, const DepthMap& depth, const cv::Mat1b& hole) {
    {
      const std::lock_guard lock(mutex_);
      if (!is_wanted(view)) return;
    }
    PackedDepth packed(depth, hole);
    const std::lock_guard lock(mutex_);
    if (!is_wanted(view)) return;
    const bool is_expected = expected_.contains(view);
    while (!is_expected && !items_.empty() && items_.rbegin()->first > view && bytes_ + packed.bytes() > max_bytes_)
      drop(std::prev(items_.end()));
    if (!is_expected && bytes_ + packed.bytes() > max_bytes_) return;
    const std::size_t bytes = packed.bytes();
    if (items_.emplace(view, std::move(packed)).second) bytes_ += bytes;
  }
  /// Removes and returns the depth map of a view; none if it is not stored.
  std::optional<PackedDepth> take(std::size_t view) {
    const std::lock_guard lock(mutex_);
    taken_.insert(view);
    expected_.erase(view);
    const auto it = items_.find(view);
    if (it == items_.end()) return std::nullopt;
    std::optional<PackedDepth> out = std::move(it->second);
    drop(it);
    return out;
  }

 private:
  using Items = std::map<std::size_t, PackedDepth>;

  bool is_wanted(std::size_t view) const {
    return !items_.contains(view) && (!taken_.contains(view) || expected_.contains(view));
  }
  void drop(Items::iterator item) {
    bytes_ -= item->second.bytes();
    items_.erase(item);
  }

  const std::size_t max_bytes_ =
      std::min(kPackedDepth.max_bytes, WorkMemory::of_process()->bound() / kPackedDepth.work_memory_divisor);
  std::mutex mutex_;
  Items items_;
  std::set<std::size_t> taken_, expected_;
  std::size_t bytes_ = 0;
};

/// Sets `sigma` to 0 outside the mask, as packing does, so that the result does not depend on which use of the view came first.
DepthMap limit_sigma_to(const cv::Mat1b& mask, DepthMap depth) {
  depth.sigma.setTo(0, mask == 0);
  return depth;
}

}  // namespace

Depths::Depths(const Views& views, const std::function<DepthMap(std::size_t)>& make) {
  const auto packed_depths = std::make_shared<PackedDepths>();
  visibility = {views.size(), [make, packed_depths, masks = views.masks, unknown = views.unknown, returns = views.returns,
                               targets = views.targets()](std::size_t i) {
                  const DepthMap depth = make(i);
                  const std::shared_ptr<const cv::Mat1b> mask = masks[i];
                  if (i < targets) packed_depths->put(i, depth, *mask);
                  cv::Mat1b hidden = mask->clone();
                  if (!unknown.empty() && !unknown[i]->empty()) hidden.setTo(255, *unknown[i]);
                  if (!returns.empty()) hidden.setTo(255, find_occluders(depth, *returns[i]));
                  return make_visibility_map(depth, hidden);
                }};
  // The visibility map of a target is needed, too: it is made first, from the same depth map.
  make_map = [make, packed_depths, visibility = visibility, masks = views.masks](std::size_t i) {
    packed_depths->expect(i);
    visibility[i];
    const std::optional<PackedDepth> packed = packed_depths->take(i);
    return packed ? packed->unpack(*masks[i]) : limit_sigma_to(*masks[i], make(i));
  };
}

}  // namespace dvi::depth
