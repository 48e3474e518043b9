#include "dvi/run/smoothed_frames.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "dvi/core/threads.h"

namespace dvi::run {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// A frame in progress, as an item of the pipeline. The next item of its sequence completes it.
struct ItemInProgress {
  std::size_t view = 0;
  std::size_t previous = kNone, next = kNone;  ///< Items of the frames before and after it that are filled.
  bool is_written = false;                     ///< Otherwise, it is only filled for its neighbors.
  std::shared_ptr<const result::FilledView> filled;
  std::shared_ptr<const smooth::FramePair> before;  ///< with the frame before it
};

/// Returns the frames of the same camera before and after a view.
std::vector<std::size_t> list_neighbors(const Views& views, std::size_t view) {
  const auto [first, last] = views.of_sequence(views[view].sequence);
  std::vector<std::size_t> out;
  if (view > first) out.push_back(view - 1);
  if (view + 1 < last) out.push_back(view + 1);
  return out;
}

/// Lists the frames to be filled, in order of time: those to be written, and their neighbors.
std::vector<ItemInProgress> list_items(const std::vector<std::size_t>& targets, const Views& views, bool smooth) {
  std::set<std::size_t> needed(targets.begin(), targets.end());
  if (smooth)
    for (const std::size_t view : targets)
      for (const std::size_t neighbor : list_neighbors(views, view)) needed.insert(neighbor);
  std::vector<std::size_t> order = views.targets_in_time();
  std::erase_if(order, [&](std::size_t view) { return !needed.contains(view); });
  std::map<std::size_t, std::size_t> item_of;
  for (std::size_t i = 0; i < order.size(); ++i) item_of[order[i]] = i;
  std::vector<ItemInProgress> items;
  for (const std::size_t view : order) {
    ItemInProgress item;
    item.view = view;
    item.is_written = std::binary_search(targets.begin(), targets.end(), view);
    for (const std::size_t neighbor : list_neighbors(views, view))
      if (const auto found = item_of.find(neighbor); smooth && found != item_of.end())
        (neighbor < view ? item.previous : item.next) = found->second;
    items.push_back(std::move(item));
  }
  return items;
}

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

void for_each_smoothed(const std::vector<std::size_t>& targets, const Views& views, const FrameSteps& steps) {
  using enum PipelineStep::Order;
  std::vector<ItemInProgress> items = list_items(targets, views, steps.smoothing.has_value());
  const auto fill = [&](std::size_t i) {
    items[i].filled = std::make_shared<const result::FilledView>(steps.fill(items[i].view));
  };
  // The steps in ascending order only wait until the frame before, and then its pair, are made.
  const auto wait = [](std::size_t) {};
  const auto pair = [&](std::size_t i) {
    if (items[i].previous == kNone) return;
    const ItemInProgress& earlier = items[items[i].previous];
    items[i].before =
        std::make_shared<const smooth::FramePair>(steps.smoothing->pair(earlier.filled->frame, items[i].filled->frame));
  };
  const auto write = [&](const ItemInProgress& item, const smooth::FramePair* after) {
    if (!item.is_written) return;
    result::FilledView finished = *item.filled;
    if (steps.smoothing) finished.frame = steps.smoothing->smooth(item.before.get(), item.filled->frame, after);
    steps.write(item.view, finished);
  };
  const auto write_completed = [&](std::size_t i) {
    if (items[i].previous != kNone) write(items[items[i].previous], items[i].before.get());
    if (items[i].next == kNone) write(items[i], nullptr);
  };
  const auto release_item = [&](std::size_t i) {
    items[i].filled.reset();
    items[i].before.reset();
  };
  const auto release_completed = [&](std::size_t i) {
    if (items[i].previous != kNone) release_item(items[i].previous);
    if (items[i].next == kNone) release_item(i);
  };
  run_pipeline(
      items.size(),
      {{any, fill}, {ascending, wait}, {any, pair}, {ascending, wait}, {any, write_completed}, {ascending, release_completed}},
      steps.bytes_per_frame);
}

}  // namespace dvi::run
