#include "dvi/pipeline/run.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/depth/depths.h"
#include "dvi/pipeline/fill.h"
#include "dvi/pipeline/make_map.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/run_baseline.h"
#include "dvi/pipeline/run_result.h"

namespace dvi {
namespace {

void share_light(Views& views, const StaticMap& map, const std::vector<OpenDrive>& drives, Progress& progress) {
  progress.begin("exposure", views.size());
  const std::vector<int> compared = estimate_exposure(views, map, progress.tick());
  const auto alone = std::count(compared.begin(), compared.end(), 0);
  if (alone == 0) return;
  const View& first = views[static_cast<std::size_t>(std::find(compared.begin(), compared.end(), 0) - compared.begin())];
  progress.warn(
      fmt::format("exposure: {} of {} frames (first: {}) show too few points of the map in common with others; their "
                  "light is taken as it is",
                  alone, views.size(), drives[static_cast<std::size_t>(first.drive)].drive.frames[first.frame].name));
}

}  // namespace

std::string run(const Job& job, Progress& progress) {
  if (is_baseline(job.method)) return run_baseline(job, progress);
  const Options& options = job.options;
  std::vector<OpenDrive> drives = open_drives(job, MaskNeed::required, progress);
  if (const std::optional<std::string> report = finished_report(job, drives, progress)) return *report;
  find_poses(drives, job, progress);  // section 3.1: LOAM
  Views views = make_views(drives, progress);
  RunResult result(job, drives, views, progress);
  verify(drives, progress);

  CpuClock clock;
  const StaticMap map = map_drives(drives, options.map, progress);
  if (options.exposure.enabled) share_light(views, map, drives, progress);
  progress.begin("align", align_steps(views, options.align));
  const Alignment alignment = align(views, map, options.align, progress.tick());  // eq. 1
  for (const std::string& warning : alignment.warnings) progress.warn(warning);
  const Depths depths(views, options.depth.mask_margin_px, [&](std::size_t i) {
    return clock.time("depth", [&] { return depth_map(map, views[i], options.depth); });
  });
  const Filler fill(views, depths, options, clock);  // sample; regularize, eqs. 2-4; harmonize, eq. 5
  result.make_frames(fill, alignment, clock);        // ... a frame, and smooth
  return result.complete(&map, alignment, clock);
}

}  // namespace dvi
