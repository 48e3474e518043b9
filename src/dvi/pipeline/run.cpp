#include "dvi/pipeline/run.h"

#include "dvi/depth/depths.h"
#include "dvi/pipeline/fill.h"
#include "dvi/pipeline/make_map.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/refine.h"
#include "dvi/pipeline/run_baseline.h"
#include "dvi/pipeline/run_result.h"

namespace dvi::pipeline {

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
  const map::StaticMap map = map_drives(drives, options.map, progress);
  share_light(views, map, drives, options, progress);
  const align::Alignment alignment = align_views(views, map, options, progress);  // eq. 1
  const depth::Depths depths(views, options.depth.mask_margin_px, [&](std::size_t i) {
    return clock.time("depth", [&] { return depth::depth_map(map, views[i], options.depth); });
  });
  const Filler fill(views, depths, options, clock);  // sample; regularize, eqs. 2-4; harmonize, eq. 5
  result.make_frames(fill, alignment, clock);        // ... a frame, and smooth
  return result.complete(&map, alignment, clock);
}

}  // namespace dvi::pipeline
