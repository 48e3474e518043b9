#include "dvi/pipeline/refine.h"

#include <algorithm>

#include <fmt/format.h>

namespace dvi::pipeline {

exposure::Gains estimate_exposure(const Views& views, const map::VisibleMap& map, const Recordings& drives,
                                  const Options& options, Progress& progress) {
  if (!options.exposure.enabled) return exposure::Gains(views.size());
  progress.begin("exposure", views.size());
  exposure::Gains gains = exposure::estimate_exposure(views, map, progress.tick());
  const auto alone = std::count(gains.compared.begin(), gains.compared.end(), 0);
  if (alone == 0) return gains;
  const auto first_alone = std::find(gains.compared.begin(), gains.compared.end(), 0) - gains.compared.begin();
  const View& first = views[static_cast<std::size_t>(first_alone)];
  progress.warn(
      fmt::format("exposure: {} of {} frames (first: {}) show too few points of the map in common with others; their "
                  "light is taken as it is",
                  alone, views.size(), drives[static_cast<std::size_t>(first.sequence)].drive.frames[first.frame].name));
  return gains;
}

align::Cameras align(const Views& views, const map::VisibleMap& map, const Recordings& drives, const Options& options,
                     Progress& progress) {
  progress.begin("align", align::align_steps(views, options.align));
  align::Cameras cameras = align::align(views, map, options.align, progress.tick());
  for (std::size_t i = 0; i < cameras.sequences.size(); ++i)
    for (const std::string& warning : cameras.sequences[i].warnings)
      progress.warn(fmt::format("align: {}: {}", name_of(drives[i]), warning));
  return cameras;
}

}  // namespace dvi::pipeline
