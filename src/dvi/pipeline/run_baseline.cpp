#include "dvi/pipeline/run_baseline.h"

#include "dvi/baselines/baselines.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/run_result.h"

namespace dvi::pipeline {
namespace {

FillFrame filler_of(const Job& job, const Views& views, CpuClock& clock) {
  if (job.method == "flow")
    return [&, flows = baselines::hole_flows(views, job.options.flow)](std::size_t target) -> FilledView {
      return {clock.time("flow", [&] { return baselines::flow_fill(views, target, flows, job.options.flow); })};
    };
  const baselines::Inpainting inpainting =
      job.method == "telea" ? baselines::Inpainting::telea : baselines::Inpainting::navier_stokes;
  return [&, inpainting](std::size_t target) -> FilledView {
    return {clock.time("inpaint", [&] { return baselines::inpaint_frame(views, target, inpainting); })};
  };
}

}  // namespace

std::string run_baseline(const Job& job, Progress& progress) {
  const std::vector<OpenDrive> drives = open_images(job, progress);
  if (const std::optional<std::string> report = finished_report(job, drives, progress)) return *report;
  const Views views = make_unposed_views(drives);
  RunResult result(job, drives, views, progress);
  verify(drives, progress);
  CpuClock clock;
  const align::Alignment none{std::vector<align::ViewAlignment>(views.size()), {}, {}};
  result.make_frames(filler_of(job, views, clock), none, clock);
  return result.complete(nullptr, none, clock);
}

}  // namespace dvi::pipeline
