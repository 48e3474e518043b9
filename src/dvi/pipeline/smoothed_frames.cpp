#include "dvi/pipeline/smoothed_frames.h"

#include <map>
#include <memory>
#include <set>

#include "dvi/core/threads.h"

namespace dvi::pipeline {
namespace {

using Window = std::map<std::size_t, std::shared_ptr<const FilledView>>;

std::set<std::size_t> with_neighbours(const std::vector<std::size_t>& block, std::size_t count) {
  std::set<std::size_t> out(block.begin(), block.end());
  for (const std::size_t view : block) {
    if (view > 0) out.insert(view - 1);
    if (view + 1 < count) out.insert(view + 1);
  }
  return out;
}

/// Brings the window to hold just these views.
void move_window(Window& window, const std::set<std::size_t>& needed, const FrameSteps& steps) {
  std::erase_if(window, [&](const auto& item) { return !needed.contains(item.first); });
  std::vector<std::size_t> missing;
  for (const std::size_t view : needed)
    if (!window.contains(view)) missing.push_back(view);
  std::vector<std::shared_ptr<const FilledView>> made(missing.size());
  parallel_for(missing.size(), [&](std::size_t i) { made[i] = std::make_shared<FilledView>(steps.fill(missing[i])); });
  for (std::size_t i = 0; i < missing.size(); ++i) window[missing[i]] = made[i];
}

FilledView finished(const Window& window, std::size_t view, const FrameSteps& steps) {
  FilledView out = *window.at(view);
  if (!steps.smooth) return out;
  const auto frame_at = [&](std::size_t i) -> const harmonize::FilledFrame* {
    const auto it = window.find(i);
    return it == window.end() ? nullptr : &it->second->frame;
  };
  out.frame = steps.smooth(view > 0 ? frame_at(view - 1) : nullptr, window.at(view)->frame, frame_at(view + 1));
  return out;
}

}  // namespace

decltype(FrameSteps::smooth) smoother(const smooth::SmoothOptions& options, CpuClock& cpu) {
  if (!options.enabled) return {};
  return [&options, &cpu](const harmonize::FilledFrame* before, const harmonize::FilledFrame& frame,
                          const harmonize::FilledFrame* after) {
    return cpu.time("smooth", smooth::smooth, before, frame, after, options);
  };
}

void for_each_smoothed(const std::vector<std::size_t>& views, std::size_t count, const FrameSteps& steps) {
  Window window;
  for_blocks(views.size(), [&](std::size_t first, std::size_t last) {
    const std::vector<std::size_t> block(views.begin() + static_cast<std::ptrdiff_t>(first),
                                         views.begin() + static_cast<std::ptrdiff_t>(last));
    const std::set<std::size_t> needed =
        steps.smooth ? with_neighbours(block, count) : std::set<std::size_t>(block.begin(), block.end());
    move_window(window, needed, steps);
    parallel_for(block.size(), [&](std::size_t i) { steps.write(block[i], finished(window, block[i], steps)); });
  });
}

}  // namespace dvi::pipeline
