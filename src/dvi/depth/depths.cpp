#include "dvi/depth/depths.h"

#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "dvi/core/threads.h"
#include "dvi/depth/occluders.h"
#include "dvi/depth/packed_depth.h"

namespace dvi::depth {
namespace {

/// Parameters of the store of packed depth maps.
struct PackedDepthParams {
  std::size_t max_bytes = std::size_t{192} << 20;  ///< Memory of all packed depth maps together.
};
constexpr PackedDepthParams kPackedDepth;

/// Packed depth maps of views that will be targets later.
class PackedDepths {
 public:
  /// Stores a depth map. If the bound is reached, the depth maps of the last views are dropped, which are needed last.
  void put(std::size_t view, const DepthMap& depth, const cv::Mat1b& hole) {
    {
      const std::lock_guard lock(mutex_);
      if (taken_.contains(view) || items_.contains(view)) return;
    }
    PackedDepth packed(depth, hole);
    const std::lock_guard lock(mutex_);
    if (taken_.contains(view)) return;
    while (!items_.empty() && items_.rbegin()->first > view && bytes_ + packed.bytes() > kPackedDepth.max_bytes)
      drop(std::prev(items_.end()));
    if (bytes_ + packed.bytes() > kPackedDepth.max_bytes) return;
    const std::size_t bytes = packed.bytes();
    if (items_.emplace(view, std::move(packed)).second) bytes_ += bytes;
  }
  /// Removes and returns the depth map of a view; none if it is not stored.
  std::optional<PackedDepth> take(std::size_t view) {
    const std::lock_guard lock(mutex_);
    taken_.insert(view);
    const auto it = items_.find(view);
    if (it == items_.end()) return std::nullopt;
    std::optional<PackedDepth> out = std::move(it->second);
    drop(it);
    return out;
  }

 private:
  using Items = std::map<std::size_t, PackedDepth>;

  void drop(Items::iterator item) {
    bytes_ -= item->second.bytes();
    items_.erase(item);
  }

  std::mutex mutex_;
  Items items_;
  std::set<std::size_t> taken_;
  std::size_t bytes_ = 0;
};

/// Sets `sigma` to 0 outside the mask, as packing does, so that the result does not depend on which use of the view came first.
DepthMap limit_sigma_to(const cv::Mat1b& mask, const DepthMap& whole) {
  DepthMap out{whole.z, cv::Mat1f(mask.size(), 0.0F)};
  whole.sigma.copyTo(out.sigma, mask);
  return out;
}

}  // namespace

Depths::Depths(const Views& views, const std::function<DepthMap(std::size_t)>& make) {
  const std::size_t in_progress = static_cast<std::size_t>(thread_count()) + 2;
  const Lazy<DepthMap> whole(views.size(), in_progress, make);
  const auto packed_depths = std::make_shared<PackedDepths>();
  maps = {views.size(), in_progress, [whole, packed_depths, masks = views.masks](std::size_t i) {
            const std::optional<PackedDepth> packed = packed_depths->take(i);
            return packed ? packed->unpack(*masks[i]) : limit_sigma_to(*masks[i], *whole[i]);
          }};
  visibility = {views.size(), [whole, packed_depths, masks = views.masks, returns = views.returns,
                               targets = views.of_sequence(0).second](std::size_t i) {
                  const std::shared_ptr<const DepthMap> depth = whole[i];
                  const std::shared_ptr<const cv::Mat1b> mask = masks[i];
                  if (i < targets) packed_depths->put(i, *depth, *mask);
                  if (returns.empty()) return make_visibility_map(*depth, *mask);
                  return make_visibility_map(*depth, cv::Mat1b(*mask | find_occluders(*depth, *returns[i])));
                }};
}

}  // namespace dvi::depth
