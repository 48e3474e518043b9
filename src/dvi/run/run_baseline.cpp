#include "dvi/run/run_baseline.h"

#include <numeric>

#include "dvi/baselines/baselines.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/make_views.h"
#include "dvi/result/result_folder.h"
#include "dvi/run/run_stages.h"
#include "dvi/run/smoothed_frames.h"

namespace dvi::run {
namespace {

std::function<result::FilledView(std::size_t)> make_filler(const job::Job& job, const Views& views, result::CpuClock& cpu) {
  if (job.method == job::Method::flow)
    return [&, flows = baselines::make_hole_flows(views, job.options.flow)](std::size_t i) -> result::FilledView {
      return {cpu.time("flow", baselines::fill_along_flow, views, i, flows, job.options.flow), std::nullopt};
    };
  const baselines::Inpainting inpainting =
      job.method == job::Method::telea ? baselines::Inpainting::telea : baselines::Inpainting::navier_stokes;
  return [&, inpainting](std::size_t i) -> result::FilledView {
    return {cpu.time("inpaint", baselines::inpaint_frame, views, i, inpainting), std::nullopt};
  };
}

}  // namespace

result::RunReport run_baseline(const job::Job& job, Progress& progress, const FrameSink& sink) {
  progress.plan(plan_run_stages(job));
  job::require_one_camera(job.read.camera, "--method " + to_string(job.method));
  const inputs::Recordings drives = inputs::open_images(job, progress);
  if (job.method == job::Method::flow) inputs::require_provenance_range(drives);
  result::ResultFolder out(job, drives);
  if (const std::optional<result::RunReport> finished = out.read_finished_report(progress)) return *finished;
  out.claim();
  inputs::verify(drives, job, progress);

  const inputs::Poses poses = inputs::use_given_poses(drives);
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  const Views views = inputs::make_unposed_views(drives, masks);
  const align::Cameras cameras(views);
  result::CpuClock cpu;
  std::vector<std::size_t> all(views.targets());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<std::size_t> missing = out.begin_fill(views, all, progress);
  if (sink.begin) sink.begin({out.frame_names(), views.targets_in_time(), missing});
  const auto finish_frame = [&](std::size_t number, const harmonize::FilledFrame& frame) {
    if (sink.finished) sink.finished(number, frame);
    progress.advance();
  };
  progress.begin("fill", missing.size());
  for_each_smoothed(missing, views,
                    {.fill = make_filler(job, views, cpu),
                     .smoothing = make_smoothing(job.options.smooth, cpu),
                     .write = out.make_writer(views, cameras, cpu, finish_frame)});
  return out.complete(
      {.views = views, .map = nullptr, .poses = poses, .cameras = cameras, .cpu = cpu, .objects = {&masks.front().objects, 1}},
      progress);
}

}  // namespace dvi::run
