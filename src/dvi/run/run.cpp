#include "dvi/run/run.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/result/plan_manifest.h"
#include "dvi/result/usable_folder.h"
#include "dvi/run/drive_run.h"
#include "dvi/run/run_baseline.h"
#include "dvi/run/sectioned_run.h"

namespace dvi::run {

using result::StageCache;

namespace {

/// Lists the numbers of frames, each once and ascending, also if several cameras have it.
template <class Planned>
std::vector<int> numbers_of(const Planned& run, const std::vector<std::size_t>& frames) {
  std::set<int> numbers;
  for (const std::size_t frame : frames) numbers.insert(run.number_of(frame));
  return {numbers.begin(), numbers.end()};
}

template <class Planned>
std::vector<std::size_t> all_frames(const Planned& run) {
  std::vector<std::size_t> frames(run.frames());
  std::iota(frames.begin(), frames.end(), std::size_t{0});
  return frames;
}

/// Returns "A:B" for each range of consecutive frames.
template <class Planned>
std::vector<std::string> ranges_of(const Planned& run, const std::vector<std::size_t>& frames) {
  const std::vector<int> all = numbers_of(run, all_frames(run)), numbers = numbers_of(run, frames);
  std::vector<std::string> out;
  for (auto first = numbers.begin(); first != numbers.end();) {
    const auto in_all = std::lower_bound(all.begin(), all.end(), *first);
    const auto last = std::mismatch(first, numbers.end(), in_all, all.end()).first;
    out.push_back(fmt::format("{}:{}", *first, *std::prev(last)));
    first = last;
  }
  return out;
}

template <class Planned>
PlanReport report_plan(Planned& run) {
  const std::vector<std::size_t> frames = all_frames(run);
  PlanReport report{.frames = numbers_of(run, frames)};
  report.finished = report.frames.size() - numbers_of(run, run.begin_fill(frames)).size();
  return report;
}

/// Fills the missing frames of a run, and completes it.
template <class Planned>
result::RunReport fill_and_finish(Planned& run, const FrameSink& sink) {
  const std::vector<std::size_t> missing = run.begin_fill(all_frames(run));
  if (sink.begin) sink.begin({run.folder().frame_names(), run.views().targets_in_time(), missing});
  run.fill_frames(missing, sink.finished);
  return run.finish();
}

template <class Planned>
FillReport fill_range(Planned& run, const job::Job& job, const std::optional<FrameRange>& range, Progress& progress) {
  std::vector<std::size_t> frames = all_frames(run);
  if (range) std::erase_if(frames, [&](std::size_t i) { return !range->contains(run.number_of(i)); });
  if (frames.empty()) throw InputError(job.out, fmt::format("has no frames {}:{}", range->first, range->last));
  const std::vector<std::size_t> missing = run.begin_fill(frames);
  run.fill_frames(missing);
  run.store_segments(frames);
  run.folder().write_fill_cost(missing, run.cpu(), progress);
  return {.frames = frames.size(), .filled = missing.size()};
}

template <class Planned>
result::RunReport finish_plan(Planned& run, const job::Job& job) {
  if (const std::vector<std::size_t> missing = run.begin_fill(all_frames(run)); !missing.empty()) {
    const std::vector<std::string> ranges = ranges_of(run, missing);
    throw InputError(job.out, fmt::format("lacks {} of {} frames: {}", missing.size(), run.frames(), fmt::join(ranges, ", ")),
                     fmt::format("dvi fill {} --frames {} fills the first range", job.out, ranges.front()));
  }
  run.fill_frames({});
  return run.finish();
}

/// Plans all sections of a drive, and joins them. Returns the report if the result is finished.
std::optional<result::RunReport> plan_sections(SectionedRun& run, Progress& progress) {
  for (std::size_t k = 1; k <= run.sections(); ++k) {
    progress.note(fmt::format("section {} of {}", k, run.sections()));
    run.plan(k);
  }
  run.open_folder();
  if (auto finished = run.folder().read_finished_report(progress)) return finished;
  run.join();
  return std::nullopt;
}

void require_plannable(const job::Job& job) {
  result::require_usable_folder(job);
  if (job::is_baseline(job.method))
    throw UsageError(
        fmt::format("--method {} cannot be planned: it fills each frame alone; use dvi run", to_string(job.method)));
}

}  // namespace

result::RunReport run(const job::Job& job, Progress& progress, const FrameSink& sink) {
  result::require_usable_folder(job);
  if (job::is_baseline(job.method)) return run_baseline(job, progress, sink);
  if (const std::size_t sections = count_sections(job); sections > 1) {
    SectionedRun run(job, sections, progress);
    if (const std::optional<result::RunReport> finished = plan_sections(run, progress)) return *finished;
    return fill_and_finish(run, sink);
  }
  DriveRun run(job, progress);
  if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
  run.folder().claim();
  run.plan();
  return fill_and_finish(run, sink);
}

PlanReport plan(const job::Job& job, Progress& progress) {
  require_plannable(job);
  if (const std::size_t sections = count_sections(job); sections > 1) {
    SectionedRun run(job, sections, progress);
    if (plan_sections(run, progress)) run.join();
    PlanReport report = report_plan(run);
    run.folder().write_plan(progress, sections);
    return report;
  }
  DriveRun run(job, progress);
  run.folder().claim();
  run.plan();
  PlanReport report = report_plan(run);
  run.folder().write_plan(progress);
  return report;
}

PlanReport plan_section(const job::Job& job, std::size_t section, Progress& progress) {
  require_plannable(job);
  const std::size_t sections = count_sections(job);
  if (section < 1 || section > sections)
    throw UsageError(fmt::format("there is no section {} of {}: sections are numbered from 1", section, sections));
  SectionedRun run(job, sections, progress);
  return {run.plan(section), 0};
}

PlanReport join(const job::Job& job, Progress& progress) {
  SectionedRun run(job, count_sections(job), progress);
  run.open_folder();
  run.join();
  PlanReport report = report_plan(run);
  run.folder().write_plan(progress, run.sections());
  return report;
}

FillReport fill(const job::Job& job, const std::optional<FrameRange>& range, Progress& progress) {
  const result::PlanManifest plan = result::read_plan(job.out);
  if (plan.sections > 1) {
    SectionedRun run(job, plan.sections, progress);
    run.open_folder();
    run.use_plan_to_fill();
    return fill_range(run, job, range, progress);
  }
  DriveRun run(job, progress, plan.content);
  run.folder().join();
  run.plan(StageCache::Missing::refuse);
  return fill_range(run, job, range, progress);
}

result::RunReport finish(const job::Job& job, Progress& progress) {
  if (const result::PlanManifest plan = result::read_plan(job.out); plan.sections > 1) {
    SectionedRun run(job, plan.sections, progress);
    run.open_folder();
    if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
    run.use_plan_to_finish();
    return finish_plan(run, job);
  }
  DriveRun run(job, progress);
  if (const std::optional<result::RunReport> finished = run.folder().read_finished_report(progress)) return *finished;
  run.folder().claim_plan();
  run.plan(StageCache::Missing::refuse);
  return finish_plan(run, job);
}

}  // namespace dvi::run
