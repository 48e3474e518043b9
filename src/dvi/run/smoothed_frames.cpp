#include "dvi/run/smoothed_frames.h"

#include <algorithm>
#include <memory>
#include <set>

#include "dvi/core/threads.h"

namespace dvi::run {
namespace {

/// A frame in progress. The next item of the pipeline completes it.
struct ItemInProgress {
  std::shared_ptr<const result::FilledView> filled;
  std::shared_ptr<const smooth::FramePair> before;  ///< with the frame before it
};

/// Lists the views to be filled: those to be written, and their neighbors.
std::vector<std::size_t> list_needed(const std::vector<std::size_t>& views, std::size_t count, bool smooth) {
  std::set<std::size_t> needed(views.begin(), views.end());
  if (smooth)
    for (const std::size_t view : views) {
      if (view > 0) needed.insert(view - 1);
      if (view + 1 < count) needed.insert(view + 1);
    }
  return {needed.begin(), needed.end()};
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

void for_each_smoothed(const std::vector<std::size_t>& views, std::size_t count, const FrameSteps& steps) {
  using enum PipelineStep::Order;
  const std::vector<std::size_t> needed = list_needed(views, count, steps.smoothing.has_value());
  std::vector<ItemInProgress> items(needed.size() + 2);  // item i + 1 belongs to needed[i]
  const auto is_next = [&](std::size_t i) { return i > 0 && i < needed.size() && needed[i] == needed[i - 1] + 1; };
  const auto fill = [&](std::size_t i) {
    if (i < needed.size()) items[i + 1].filled = std::make_shared<const result::FilledView>(steps.fill(needed[i]));
  };
  // The steps in ascending order only wait until the frame before, and then its pair, are made.
  const auto wait = [](std::size_t) {};
  const auto pair = [&](std::size_t i) {
    if (steps.smoothing && is_next(i))
      items[i + 1].before =
          std::make_shared<const smooth::FramePair>(steps.smoothing->pair(items[i].filled->frame, items[i + 1].filled->frame));
  };
  const auto write = [&](std::size_t i) {  // the frame before item i
    if (i == 0) return;
    const ItemInProgress &item = items[i], &after = items[i + 1];
    if (!std::binary_search(views.begin(), views.end(), needed[i - 1])) return;
    result::FilledView finished = *item.filled;
    if (steps.smoothing) finished.frame = steps.smoothing->smooth(item.before.get(), item.filled->frame, after.before.get());
    steps.write(needed[i - 1], finished);
  };
  // The pair of the next frame refers to frame i - 1, but no longer to the one before.
  const auto release = [&](std::size_t i) {
    if (i > 0) items[i - 1] = {};
  };
  run_pipeline(needed.empty() ? 0 : needed.size() + 1,
               {{any, fill}, {ascending, wait}, {any, pair}, {ascending, wait}, {any, write}, {ascending, release}},
               steps.bytes_per_frame);
}

}  // namespace dvi::run
