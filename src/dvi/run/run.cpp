#include "dvi/run/run.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/result/plan_manifest.h"
#include "dvi/run/drive_run.h"
#include "dvi/run/run_baseline.h"

namespace dvi::run {

using result::StageCache;

result::RunReport run(const job::Job& job, Progress& progress, const FrameSink& sink) {
  result::require_usable_folder(job);
  if (job::is_baseline(job.method)) return run_baseline(job, progress, sink);
  DriveRun run(job, progress);
  if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
  run.folder().claim();
  run.plan();
  const std::vector<std::size_t> missing = run.find_missing_frames();
  if (sink.begin) sink.begin(run.folder().frame_names(), missing);
  run.fill_frames(missing, sink.finished);
  return run.finish();
}

PlanReport plan(const job::Job& job, Progress& progress) {
  result::require_usable_folder(job);
  if (job::is_baseline(job.method))
    throw UsageError(
        fmt::format("--method {} cannot be planned: it fills each frame alone; use dvi run", to_string(job.method)));
  DriveRun run(job, progress);
  run.folder().claim();
  run.plan();
  PlanReport report;
  for (std::size_t i = 0; i < run.frames(); ++i) report.frames.push_back(run.number_of(i));
  report.finished = report.frames.size() - run.find_missing_frames().size();
  run.folder().write_plan(progress);
  return report;
}

FillReport fill(const job::Job& job, const std::optional<FrameRange>& range, Progress& progress) {
  DriveRun run(job, progress, result::read_plan(job.out).content);
  run.folder().join();
  run.plan(StageCache::Missing::refuse);
  const auto is_in_range = [&](std::size_t i) { return !range || range->contains(run.number_of(i)); };
  FillReport report;
  for (std::size_t i = 0; i < run.frames(); ++i) report.frames += is_in_range(i) ? 1 : 0;
  if (report.frames == 0) throw InputError(job.out, fmt::format("has no frames {}:{}", range->first, range->last));
  std::vector<std::size_t> missing = run.find_missing_frames();
  std::erase_if(missing, [&](std::size_t i) { return !is_in_range(i); });
  run.fill_frames(missing);
  run.folder().write_fill_cost(missing, run.cpu(), progress);
  report.filled = missing.size();
  return report;
}

result::RunReport finish(const job::Job& job, Progress& progress) {
  DriveRun run(job, progress);
  if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
  run.folder().claim_plan();
  run.plan(StageCache::Missing::refuse);
  if (const std::vector<std::size_t> missing = run.find_missing_frames(); !missing.empty()) {
    const std::vector<std::string> ranges = run.ranges_of(missing);
    throw InputError(job.out, fmt::format("lacks {} of {} frames: {}", missing.size(), run.frames(), fmt::join(ranges, ", ")),
                     fmt::format("dvi fill {} --frames {} fills the first range", job.out, ranges.front()));
  }
  run.fill_frames({});
  return run.finish();
}

}  // namespace dvi::run
