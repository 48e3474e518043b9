#include "dvi/pipeline/run_baseline.h"

#include "dvi/baselines/baselines.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/run_result.h"

namespace dvi {
namespace {

FillFrame filler_of(const Job& job, const Views& views, CpuClock& clock) {
  if (job.method == "flow")
    return [&, flows = hole_flows(views, job.options.flow)](std::size_t target) -> FilledView {
      return {clock.time("flow", [&] { return flow_fill(views, target, flows, job.options.flow); })};
    };
  const Inpainting inpainting = job.method == "telea" ? Inpainting::telea : Inpainting::navier_stokes;
  return [&, inpainting](std::size_t target) -> FilledView {
    return {clock.time("inpaint", [&] { return inpaint_frame(views, target, inpainting); })};
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
  const Alignment none{std::vector<ViewAlignment>(views.size()), {}, {}};
  result.make_frames(filler_of(job, views, clock), none, clock);
  return result.complete(nullptr, none, clock);
}

}  // namespace dvi
