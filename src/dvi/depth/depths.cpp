#include "dvi/depth/depths.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "dvi/core/threads.h"
#include "dvi/depth/packed_depth.h"

namespace dvi::depth {
namespace {

constexpr std::size_t kPackedBytes = std::size_t{192} << 20;

/// Depths of views whose turn is still to come, in order.
class Waiting {
 public:
  /// What does not fit is not kept: the turn of what came before it is earlier.
  void put(std::size_t view, const DepthMap& depth, const cv::Mat1b& hole) {
    {
      const std::lock_guard lock(mutex_);
      if (view < next_ || items_.contains(view)) return;
    }
    PackedDepth packed(depth, hole);
    const std::lock_guard lock(mutex_);
    if (bytes_ + packed.bytes() > kPackedBytes) return;
    const std::size_t bytes = packed.bytes();
    if (items_.emplace(view, std::move(packed)).second) bytes_ += bytes;
  }
  std::optional<PackedDepth> take(std::size_t view) {
    const std::lock_guard lock(mutex_);
    next_ = std::max(next_, view + 1);
    std::optional<PackedDepth> out;
    while (!items_.empty() && items_.begin()->first + kLate < next_) drop(items_.begin());
    const auto it = items_.find(view);
    if (it == items_.end()) return out;
    out = std::move(it->second);
    bytes_ -= out->bytes();
    items_.erase(it);
    return out;
  }

 private:
  static constexpr std::size_t kLate = 64;  // views by which threads may be apart; what is later is not asked for any more
  using Items = std::map<std::size_t, PackedDepth>;

  void drop(Items::iterator item) {
    bytes_ -= item->second.bytes();
    items_.erase(item);
  }

  std::mutex mutex_;
  Items items_;
  std::size_t bytes_ = 0, next_ = 0;
};

/// With sigma in the mask only, as a packed map keeps it: a frame must not tell by its depth which was made first.
DepthMap within(const cv::Mat1b& mask, const DepthMap& whole) {
  DepthMap out{whole.z, cv::Mat1f(mask.size(), 0.0F)};
  whole.sigma.copyTo(out.sigma, mask);
  return out;
}

}  // namespace

Depths::Depths(const Views& views, const std::function<DepthMap(std::size_t)>& make) {
  const std::size_t in_work = static_cast<std::size_t>(thread_count()) + 2;
  const Lazy<DepthMap> whole(views.size(), in_work, make);
  const auto waiting = std::make_shared<Waiting>();
  maps = {views.size(), in_work, [whole, waiting, masks = views.masks](std::size_t i) {
            const std::optional<PackedDepth> packed = waiting->take(i);
            return packed ? packed->unpack(*masks[i]) : within(*masks[i], *whole[i]);
          }};
  visibility = {views.size(), [whole, waiting, masks = views.masks, targets = views.of_sequence(0).second](std::size_t i) {
                  const std::shared_ptr<const DepthMap> depth = whole[i];
                  const std::shared_ptr<const cv::Mat1b> mask = masks[i];
                  if (i < targets) waiting->put(i, *depth, *mask);
                  return visibility_map(*depth, *mask);
                }};
}

}  // namespace dvi::depth
