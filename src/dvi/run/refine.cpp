#include "dvi/run/refine.h"

#include <algorithm>

#include <fmt/format.h>

namespace dvi::run {

exposure::Gains estimate_exposure(const Refinement& from, Progress& progress) {
  const auto& [views, map, drives, options] = from;
  if (!options.exposure.enabled) return exposure::Gains(views.size());
  progress.begin("exposure", views.size());
  exposure::Gains gains = exposure::estimate_exposure(views, map, progress.tick());
  std::vector<std::size_t> alone;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (gains.compared[i] == 0 && shares_colors(views[i], views[0])) alone.push_back(i);
  if (alone.empty()) return gains;
  const View& first = views[alone.front()];
  progress.warn(
      fmt::format("exposure: {} of {} frames (first: {}) share too few points of the map with others; their exposure "
                  "is not adjusted",
                  alone.size(), views.size(), drives[static_cast<std::size_t>(first.sequence)].drive.frames[first.frame].name));
  return gains;
}

align::Cameras align(const Refinement& from, Progress& progress) {
  const auto& [views, map, drives, options] = from;
  progress.begin("align", align::count_align_ticks(views, options.align));
  align::Cameras cameras = align::align(views, map, options.align, progress.tick());
  for (std::size_t i = 0; i < cameras.sequences.size(); ++i)
    for (const std::string& warning : cameras.sequences[i].warnings)
      progress.warn(fmt::format("align: {}: {}", inputs::name_of(drives[i]), warning));
  return cameras;
}

}  // namespace dvi::run
