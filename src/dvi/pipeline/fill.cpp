#include "dvi/pipeline/fill.h"

#include <set>

#include "dvi/core/threads.h"

namespace dvi::pipeline {

FilledView Filler::operator()(std::size_t target) const {
  std::shared_ptr<const depth::DepthMap> depth = depths_.maps[target];
  if (options_.sweep.enabled)
    depth = clock_.time("sweep", [&] {
      return std::make_shared<const depth::DepthMap>(
          plane_sweep::plane_sweep(*depth, views_, target, depths_.visibility, options_.sweep));
    });
  const sample::Candidates candidates =
      clock_.time("sample", [&] { return sample::sample(views_, target, *depth, depths_.visibility, options_.sample); });
  const regularize::Labelling labels = clock_.time(
      "regularize", [&] { return regularize::regularize(candidates, views_, target, *depth, options_.regularize); });
  harmonize::FilledFrame frame = clock_.time(
      "harmonize", [&] { return harmonize::harmonize(labels.candidates, views_, target, *depth, options_.harmonize); });
  return {std::move(frame), labels.energy_before, labels.energy_after};
}

void Smoother::fill(const std::vector<std::size_t>& block) {
  std::set<std::size_t> needed(block.begin(), block.end());
  if (options_.enabled)
    for (const std::size_t view : block) {
      if (view > first_) needed.insert(view - 1);
      if (view + 1 < last_) needed.insert(view + 1);
    }
  std::erase_if(window_, [&](const auto& item) { return !needed.contains(item.first); });
  std::vector<std::size_t> missing;
  for (const std::size_t view : needed)
    if (!window_.contains(view)) missing.push_back(view);
  std::vector<std::shared_ptr<const FilledView>> made(missing.size());
  parallel_for(missing.size(), [&](std::size_t i) { made[i] = std::make_shared<FilledView>(fill_frame_(missing[i])); });
  for (std::size_t i = 0; i < missing.size(); ++i) window_[missing[i]] = made[i];
}

std::vector<FilledView> Smoother::finish(const std::vector<std::size_t>& block) {
  fill(block);
  const auto neighbour = [&](std::size_t view) -> const harmonize::FilledFrame* {
    const auto it = window_.find(view);
    return it == window_.end() ? nullptr : &it->second->frame;
  };
  std::vector<FilledView> finished(block.size());
  parallel_for(block.size(), [&](std::size_t i) {
    const std::size_t view = block[i];
    const FilledView& filled = *window_.at(view);
    const harmonize::FilledFrame* before = options_.enabled && view > first_ ? neighbour(view - 1) : nullptr;
    const harmonize::FilledFrame* after = options_.enabled && view + 1 < last_ ? neighbour(view + 1) : nullptr;
    finished[i] = filled;
    finished[i].frame = clock_.time("smooth", [&] { return smooth::smooth(before, filled.frame, after, options_); });
  });
  return finished;
}

}  // namespace dvi::pipeline
