#include "dvi/pipeline/refine.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/exposure/exposure.h"

namespace dvi::pipeline {

void share_light(Views& views, const map::StaticMap& map, const std::vector<OpenDrive>& drives, const Options& options,
                 Progress& progress) {
  if (!options.exposure.enabled) return;
  progress.begin("exposure", views.size());
  const std::vector<int> compared = exposure::estimate_exposure(views, map, progress.tick());
  const auto alone = std::count(compared.begin(), compared.end(), 0);
  if (alone == 0) return;
  const View& first = views[static_cast<std::size_t>(std::find(compared.begin(), compared.end(), 0) - compared.begin())];
  progress.warn(
      fmt::format("exposure: {} of {} frames (first: {}) show too few points of the map in common with others; their "
                  "light is taken as it is",
                  alone, views.size(), drives[static_cast<std::size_t>(first.drive)].drive.frames[first.frame].name));
}

align::Alignment align_views(Views& views, const map::StaticMap& map, const Options& options, Progress& progress) {
  progress.begin("align", align::align_steps(views, options.align));
  align::Alignment alignment = align::align(views, map, options.align, progress.tick());
  for (const std::string& warning : alignment.warnings) progress.warn(warning);
  return alignment;
}

}  // namespace dvi::pipeline
