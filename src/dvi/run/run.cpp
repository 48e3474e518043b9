#include "dvi/run/run.h"

#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/depth/depths.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/classify_surfaces.h"
#include "dvi/inputs/check_setup.h"
#include "dvi/inputs/make_views.h"
#include "dvi/inputs/rig.h"
#include "dvi/result/plan_record.h"
#include "dvi/result/result_folder.h"
#include "dvi/result/stage_fields.h"  // IWYU pragma: keep
#include "dvi/run/make_map.h"
#include "dvi/run/refine.h"
#include "dvi/run/run_baseline.h"
#include "dvi/run/run_stages.h"
#include "dvi/run/smoothed_frames.h"
#include "dvi/synthesize/synthesize.h"

namespace dvi::run {

using align::Cameras;
using depth::DepthMap, depth::Depths;
using exposure::Gains;
using ground::RoadGround, map::StaticMap, map::VisibleMap;
using harmonize::FilledFrame, harmonize::Unobserved, harmonize::HarmonizeInput;
using regularize::Labeling;
using sample::Candidates;
using synthesize::Grain;
using synthesize::Surfaces;

namespace {

/// What is global: found once, before any frame is filled.
struct Plan {
  const inputs::Poses& poses;
  const StaticMap& map;
  const Views& views;
  const Cameras& cameras;
  const inputs::Objects& objects;
};

/// Calls `then` with the plan; its stages are made unless they are kept.
template <class Then>
auto with_plan(const job::Job& job, const inputs::Recordings& drives, const result::KeptStages& kept, Progress& progress,
               const Then& then) {
  const job::Options& options = job.options;
  const inputs::Poses poses = kept("poses", [&] {
    inputs::verify(drives, job, progress);                 // what is damaged is said before hours of work
    return inputs::estimate_poses(drives, job, progress);  // 3.1: LOAM, 3.5: further drives
  });
  const inputs::Grounds grounds(drives, poses);
  const inputs::Objects objects = kept("objects", [&] { return inputs::find_objects(drives, poses, grounds, job, progress); });
  const inputs::Masks masks = inputs::find_masks(drives, poses, grounds, objects, job, progress);
  const auto static_points = [&] {
    inputs::check_setup(drives, poses, masks, progress);            // what contradicts the recording, likewise
    return build_map(drives, poses, masks, options.map, progress);  // 3.1
  };
  const StaticMap map = kept("map", static_points, StaticMap(Scratch::of_process()));
  const Views posed = inputs::make_views(drives, poses, masks, progress);
  const VisibleMap visible(map, posed);
  const Gains gains = kept("exposure", [&] { return estimate_exposure(posed, visible, drives, options, progress); });
  const Cameras cameras = kept("alignment", [&] { return align(posed, visible, drives, options, progress); });  // 3.1, eq. 1
  return then(Plan{poses, map, inputs::refined(posed, gains, cameras), cameras, objects});
}

using Write = std::function<void(std::size_t view, const result::FilledView& finished)>;

void fill_frames(const Plan& plan, const std::vector<std::size_t>& frames, const job::Options& options, const Write& write,
                 result::CpuClock& cpu, Progress& progress) {
  const Views& views = plan.views;
  const Depths depths(views, [&](std::size_t i) {  // 3.1
    return cpu.time("depth", depth::depth_map, plan.map, views[i], options.depth);
  });
  const bool classified = options.harmonize.surface_classes,
             synthesized = options.harmonize.unobserved == Unobserved::synthesize;
  std::optional<RoadGround> ground;
  std::optional<Surfaces> surfaces;
  if (!frames.empty() && (classified || synthesized)) ground.emplace(plan.map, views);
  if (ground && synthesized) surfaces.emplace(*ground, views, depths.visibility);
  const Grain grain(views);
  const auto fill = [&](std::size_t i) {
    const DepthMap depth =
        cpu.time("plane_sweep", depth::plane_sweep, *depths.maps[i], views, i, depths.visibility, options.plane_sweep);
    Candidates candidates = cpu.time("sample", sample::sample, views, i, depth, depths.visibility, options.sample);  // 3.2
    const Labeling labels = cpu.time("regularize", regularize::regularize, std::move(candidates), views, i, depth,
                                     options.regularize);  // 3.3, eqs. 2-4
    HarmonizeInput around;
    if (options.harmonize.day_light)
      around.light = cpu.time("harmonize", harmonize::compare_days, labels.candidates, views, i, depth, depths.visibility);
    if (classified)
      around.classes = cpu.time("harmonize", harmonize::classify_surfaces, views[i], depth, labels.candidates, *ground);
    around.known =
        cpu.time("sample", sample::sample_known, labels.candidates, views, i, depth, depths.visibility, options.sample);
    FilledFrame frame = cpu.time("harmonize", harmonize::harmonize, labels.candidates, views, i, depth, around,
                                 options.harmonize);  // 3.4, eq. 5
    if (surfaces) frame = cpu.time("synthesize", synthesize::synthesize, frame, views[i], around.classes, *surfaces, grain);
    return result::FilledView{std::move(frame), labels.energy};
  };
  progress.begin("fill", frames.size());
  for_each_smoothed(frames, views.of_sequence(0).second,
                    {.fill = fill, .smoothing = smoothing(options.smooth, cpu), .write = write});
  progress.end();
}

inputs::Recordings open_all(const job::Job& job, Progress& progress) {
  progress.plan(run_stages(job));
  return inputs::with_other_cameras(inputs::open_recordings(job, inputs::MaskNeed::required, progress), job, progress);
}

/// The drive's own number of a frame.
int number_of(const Views& views, std::size_t view, const inputs::Recordings& drives) {
  return drives.front().drive.frames[views[view].frame].number;
}

/// "A:B" for each run of views that follow each other.
std::vector<std::string> ranges_of(const std::vector<std::size_t>& frames, const Views& views,
                                   const inputs::Recordings& drives) {
  std::vector<std::string> out;
  for (std::size_t first = 0, next = 1; next <= frames.size(); ++next) {
    if (next < frames.size() && frames[next] == frames[next - 1] + 1) continue;
    out.push_back(fmt::format("{}:{}", number_of(views, frames[first], drives), number_of(views, frames[next - 1], drives)));
    first = next;
  }
  return out;
}

/// Fills these frames into the folder and completes it.
result::RunReport fill_and_complete(result::ResultFolder& out, const Plan& plan, const std::vector<std::size_t>& frames,
                                    const job::Options& options, Progress& progress,
                                    const result::FinishedFrame& hand_on = {}) {
  result::CpuClock cpu;
  fill_frames(plan, frames, options, out.writer(plan.views, plan.cameras, cpu, progress, hand_on), cpu, progress);
  return out.complete({.views = plan.views,
                       .map = &plan.map,
                       .poses = plan.poses,
                       .cameras = plan.cameras,
                       .cpu = cpu,
                       .objects = *plan.objects.front()},
                      progress);
}

}  // namespace

result::RunReport run(const job::Job& job, Progress& progress, const FrameSink& sink) {
  result::require_usable_folder(job.out, job.force);
  if (job::is_baseline(job.method)) return run_baseline(job, progress, sink);
  const inputs::Recordings drives = open_all(job, progress);
  result::ResultFolder out(job, drives);
  if (const std::optional<result::RunReport> finished = out.finished_report(progress)) return *finished;
  out.claim();
  return with_plan(job, drives, out.kept_stages(progress), progress, [&](const Plan& plan) {
    const std::vector<std::size_t> missing = out.missing_frames(plan.views, progress);
    if (sink.begin) sink.begin(out.frame_names(), missing);
    return fill_and_complete(out, plan, missing, job.options, progress, sink.finished);
  });
}

PlanReport plan(const job::Job& job, Progress& progress) {
  result::require_usable_folder(job.out, job.force);
  if (job::is_baseline(job.method))
    throw UsageError(fmt::format("--method {} has nothing to plan: dvi run fills each frame by itself", to_string(job.method)));
  const inputs::Recordings drives = open_all(job, progress);
  result::ResultFolder out(job, drives);
  out.claim();
  return with_plan(job, drives, out.kept_stages(progress), progress, [&](const Plan& plan) {
    PlanReport report;
    for (std::size_t i = 0; i < plan.views.of_sequence(0).second; ++i)
      report.frames.push_back(number_of(plan.views, i, drives));
    report.finished = report.frames.size() - out.missing_frames(plan.views, progress).size();
    out.write_plan(progress);
    return report;
  });
}

FillReport fill(const job::Job& job, const std::optional<FrameRange>& range, Progress& progress) {
  const inputs::Recordings drives = open_all(job, progress);
  result::ResultFolder out(job, drives, result::read_plan_record(job.out).content);
  out.join();
  return with_plan(
      job, drives, out.kept_stages(progress, result::KeptStages::Missing::refused), progress, [&](const Plan& plan) {
        const auto chosen = [&](std::size_t i) { return !range || range->contains(number_of(plan.views, i, drives)); };
        FillReport report;
        for (std::size_t i = 0; i < plan.views.of_sequence(0).second; ++i) report.frames += chosen(i) ? 1 : 0;
        if (report.frames == 0) throw InputError(job.out, fmt::format("has no frames {}:{}", range->first, range->last));
        std::vector<std::size_t> missing = out.missing_frames(plan.views, progress);
        std::erase_if(missing, [&](std::size_t i) { return !chosen(i); });
        result::CpuClock cpu;
        fill_frames(plan, missing, job.options, out.writer(plan.views, plan.cameras, cpu, progress), cpu, progress);
        out.keep_fill_cost(missing, cpu, progress);
        report.filled = missing.size();
        return report;
      });
}

result::RunReport finish(const job::Job& job, Progress& progress) {
  const inputs::Recordings drives = open_all(job, progress);
  result::ResultFolder out(job, drives);
  if (const std::optional<result::RunReport> finished = out.finished_report(progress)) return *finished;
  out.claim_plan();
  return with_plan(
      job, drives, out.kept_stages(progress, result::KeptStages::Missing::refused), progress, [&](const Plan& plan) {
        if (const std::vector<std::size_t> missing = out.missing_frames(plan.views, progress); !missing.empty()) {
          const std::vector<std::string> ranges = ranges_of(missing, plan.views, drives);
          throw InputError(job.out,
                           fmt::format("lacks {} of {} frames: {}", missing.size(), plan.views.of_sequence(0).second,
                                       fmt::join(ranges, ", ")),
                           fmt::format("dvi fill {} --frames {} makes the first of them", job.out, ranges.front()));
        }
        return fill_and_complete(out, plan, {}, job.options, progress);
      });
}

}  // namespace dvi::run
