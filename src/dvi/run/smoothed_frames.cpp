#include "dvi/run/smoothed_frames.h"

#include <map>
#include <memory>
#include <set>

#include "dvi/core/threads.h"

namespace dvi::run {
namespace {

/// Removes the items that are not needed from a window, and makes the missing ones in parallel.
template <class Item, class Make>
void move_window(std::map<std::size_t, std::shared_ptr<const Item>>& window, const std::set<std::size_t>& needed,
                 const Make& make) {
  std::erase_if(window, [&](const auto& item) { return !needed.contains(item.first); });
  std::vector<std::size_t> missing;
  for (const std::size_t i : needed)
    if (!window.contains(i)) missing.push_back(i);
  std::vector<std::shared_ptr<const Item>> made(missing.size());
  parallel_for(missing.size(), [&](std::size_t i) { made[i] = std::make_shared<const Item>(make(missing[i])); });
  for (std::size_t i = 0; i < missing.size(); ++i) window[missing[i]] = made[i];
}

/// The filled frames and pairs that a block of views needs.
class FrameWindow {
 public:
  FrameWindow(std::size_t count, const FrameSteps& steps) : count_(count), steps_(steps) {}

  void move_to(const std::vector<std::size_t>& block) {
    std::set<std::size_t> views(block.begin(), block.end()), pairs;
    if (steps_.smoothing)
      for (const std::size_t view : block)
        for (const std::size_t earlier : {view - 1, view})
          if (earlier < count_ && earlier + 1 < count_) {  // view - 1 of the first view wraps around and exceeds the count
            pairs.insert(earlier);
            views.insert({earlier, earlier + 1});
          }
    std::erase_if(pairs_, [&](const auto& pair) {
      return !pairs.contains(pair.first);
    });  // pairs refer to frames, so they are removed first
    move_window(views_, views, steps_.fill);
    move_window(pairs_, pairs, [&](std::size_t earlier) {
      return steps_.smoothing->pair(views_.at(earlier)->frame, views_.at(earlier + 1)->frame);
    });
  }

  result::FilledView smooth(std::size_t view) const {
    result::FilledView out = *views_.at(view);
    if (steps_.smoothing) out.frame = steps_.smoothing->smooth(pair(view - 1), views_.at(view)->frame, pair(view));
    return out;
  }

 private:
  const smooth::FramePair* pair(std::size_t earlier) const {
    const auto it = pairs_.find(earlier);
    return it == pairs_.end() ? nullptr : it->second.get();
  }

  std::size_t count_;
  const FrameSteps& steps_;
  std::map<std::size_t, std::shared_ptr<const result::FilledView>> views_;
  std::map<std::size_t, std::shared_ptr<const smooth::FramePair>> pairs_;  // by the earlier frame
};

}  // namespace

std::optional<Smoothing> make_smoothing(const smooth::SmoothOptions& options, result::CpuClock& cpu) {
  if (!options.enabled) return {};
  return Smoothing{.pair =
                       [&cpu](const harmonize::FilledFrame& earlier, const harmonize::FilledFrame& later) {
                         return cpu.time("smooth", [&] { return smooth::FramePair(earlier, later); });
                       },
                   .smooth =
                       [&cpu, options](const smooth::FramePair* before, const harmonize::FilledFrame& frame,
                                       const smooth::FramePair* after) {
                         return cpu.time("smooth", smooth::smooth, before, frame, after, options);
                       }};
}

void for_each_smoothed(const std::vector<std::size_t>& views, std::size_t count, const FrameSteps& steps) {
  FrameWindow window(count, steps);
  for_blocks(views.size(), [&](std::size_t first, std::size_t last) {
    const std::vector<std::size_t> block(views.begin() + static_cast<std::ptrdiff_t>(first),
                                         views.begin() + static_cast<std::ptrdiff_t>(last));
    window.move_to(block);
    parallel_for(block.size(), [&](std::size_t i) { steps.write(block[i], window.smooth(block[i])); });
  });
}

}  // namespace dvi::run
