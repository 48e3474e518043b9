#include "dvi/pipeline/run_baseline.h"

#include "dvi/baselines/baselines.h"
#include "dvi/pipeline/make_views.h"
#include "dvi/pipeline/result_folder.h"
#include "dvi/pipeline/run_stages.h"

namespace dvi::pipeline {
namespace {

std::function<FilledView(std::size_t)> filler_of(const Job& job, const Views& views, CpuClock& cpu) {
  if (job.method == Method::flow)
    return [&, flows = baselines::hole_flows(views, job.options.flow)](std::size_t i) -> FilledView {
      return {cpu.time("flow", baselines::flow_fill, views, i, flows, job.options.flow), std::nullopt};
    };
  const baselines::Inpainting inpainting =
      job.method == Method::telea ? baselines::Inpainting::telea : baselines::Inpainting::navier_stokes;
  return [&, inpainting](std::size_t i) -> FilledView {
    return {cpu.time("inpaint", baselines::inpaint_frame, views, i, inpainting), std::nullopt};
  };
}

}  // namespace

RunReport run_baseline(const Job& job, Progress& progress, const FrameSink& sink) {
  progress.plan(run_stages(job));
  const Recordings drives = open_images(job, progress);
  ResultFolder out(job, drives);
  if (const std::optional<RunReport> finished = out.finished_report(progress)) return *finished;
  out.claim();
  verify(drives, job, progress);

  const Poses poses = given_poses(drives);
  const Masks masks = find_masks(drives, poses, job, progress);
  const Views views = make_unposed_views(drives, masks);
  const align::Cameras cameras(views);
  CpuClock cpu;
  const std::vector<std::size_t> missing = out.missing_frames(views, progress);
  if (sink.begin) sink.begin(out.frame_names(), missing);
  progress.begin("fill", missing.size());
  for_each_smoothed(missing, views.of_sequence(0).second,
                    {.fill = filler_of(job, views, cpu),
                     .smoothing = smoothing(job.options.smooth, cpu),
                     .write = out.writer(views, cameras, cpu, progress, sink.finished)});
  return out.complete(
      {.views = views, .map = nullptr, .poses = poses, .cameras = cameras, .cpu = cpu, .objects = *masks.front().objects},
      progress);
}

}  // namespace dvi::pipeline
