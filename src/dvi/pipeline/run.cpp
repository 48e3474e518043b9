#include "dvi/pipeline/run.h"

#include <utility>

#include "dvi/depth/depths.h"
#include "dvi/pipeline/doubt_setup.h"
#include "dvi/pipeline/make_map.h"
#include "dvi/pipeline/make_views.h"
#include "dvi/pipeline/refine.h"
#include "dvi/pipeline/result_folder.h"
#include "dvi/pipeline/rig.h"
#include "dvi/pipeline/run_baseline.h"
#include "dvi/pipeline/smoothed_frames.h"
#include "dvi/pipeline/stage_fields.h"  // IWYU pragma: keep

namespace dvi::pipeline {

using align::Cameras;
using depth::DepthMap, depth::Depths;
using exposure::Gains;
using harmonize::FilledFrame;
using map::StaticMap, map::VisibleMap;
using regularize::Labelling;
using sample::Candidates;

RunReport run(const Job& job, Progress& progress) {
  require_usable_folder(job.out, job.force);
  if (is_baseline(job.method)) return run_baseline(job, progress);
  const Options& options = job.options;
  const Recordings drives = with_other_cameras(open_recordings(job, MaskNeed::required, progress), job, progress);
  ResultFolder out(job, drives);
  if (const std::optional<RunReport> finished = out.finished_report(progress)) return *finished;
  out.claim();
  const KeptStages kept = out.kept_stages(progress);

  const Poses poses = kept("poses", [&] {
    verify(drives, job, progress);                 // what is damaged is said before hours of work
    return estimate_poses(drives, job, progress);  // section 3.1: LOAM
  });
  const Objects objects = kept("objects", [&] { return find_objects(drives, poses, job, progress); });  // along the poses
  const Masks masks = find_masks(drives, poses, objects, job, progress);
  const auto static_points = [&] {
    doubt_setup(drives, poses, masks, progress);                    // what contradicts the recording, likewise
    return build_map(drives, poses, masks, options.map, progress);  // 3.1
  };
  const StaticMap map = kept("map", static_points, map::empty_map(options.map));
  const Views posed = make_views(drives, poses, masks, progress);
  const VisibleMap visible(map, posed);
  const Gains gains = kept("exposure", [&] { return estimate_exposure(posed, visible, drives, options, progress); });
  const Cameras cameras = kept("alignment", [&] { return align(posed, visible, drives, options, progress); });  // 3.2, eq. 1
  const Views views = refined(posed, gains, cameras);

  CpuClock cpu;
  const Depths depths(views, [&](std::size_t i) {  // 3.3
    return cpu.time("depth", depth::depth_map, map, views[i], options.depth);
  });
  const auto fill = [&](std::size_t i) {
    const DepthMap depth =
        cpu.time("plane_sweep", plane_sweep::plane_sweep, *depths.maps[i], views, i, depths.visibility, options.plane_sweep);
    Candidates candidates = cpu.time("sample", sample::sample, views, i, depth, depths.visibility, options.sample);  // 3.4
    const Labelling labels = cpu.time("regularize", regularize::regularize, std::move(candidates), views, i, depth,
                                      options.regularize);  // 3.5, eqs. 2-4
    FilledFrame frame =
        cpu.time("harmonize", harmonize::harmonize, labels.candidates, views, i, depth, options.harmonize);  // 3.6, eq. 5
    return FilledView{std::move(frame), labels.energy};
  };
  const std::vector<std::size_t> missing = out.missing_frames(views, progress);
  progress.begin("fill", missing.size());
  for_each_smoothed(
      missing, views.of_sequence(0).second,
      {.fill = fill, .smoothing = smoothing(options.smooth, cpu), .write = out.writer(views, cameras, cpu, progress)});
  return out.complete({.views = views, .map = &map, .poses = poses, .cameras = cameras, .cpu = cpu}, progress);
}

}  // namespace dvi::pipeline
