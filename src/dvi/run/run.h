#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/job/job.h"
#include "dvi/result/result_folder.h"
#include "dvi/result/run_report.h"

namespace dvi::run {

/// The frames of the target.
struct FramesToFill {
  std::vector<std::string> names;    ///< of all frames (core/frame_name.h)
  std::vector<std::size_t> order;    ///< indices of all frames in order of time, in which they are filled
  std::vector<std::size_t> missing;  ///< indices of those that will be filled, ascending; the others are finished
};

/// Receives the frames of a run in memory. Both functions may throw, which ends the run.
struct FrameSink {
  /// Called before any frame is filled.
  std::function<void(const FramesToFill& frames)> begin;
  /// Called with each frame after it was filled and written, from several threads, and not in order.
  result::FinishedFrame finished;
};

/// Runs the whole pipeline: writes the target drive without its removed objects to job.out (layout: docs/reference.md).
/// Continues an interrupted run. Throws InputError if the data or the folder cannot be used; no file is half-written then.
result::RunReport run(const job::Job& job, Progress& progress, const FrameSink& sink = {});

// plan(), fill(), and finish() are the parts of run(), and write the same files. plan() is called once, then fill() for ranges
// of frames, in any order, several at once, on any machine that has the drives and job.out under the same paths, then finish().
// Each may be called again.

/// The frames of a plan, for programs that divide them into ranges.
struct PlanReport {
  std::vector<int> frames;   ///< numbers in the drive, ascending
  std::size_t finished = 0;  ///< number of frames finished by earlier calls
};

/// Computes the stages before the fill: poses, objects, masks, map, exposure, and alignment.
PlanReport plan(const job::Job& job, Progress& progress);

/// Plans one section of the target, from 1, of job.sections; join() needs the plans of all. Returns the frames that it fills.
/// Throws UsageError if there is no such section.
PlanReport plan_section(const job::Job& job, std::size_t section, Progress& progress);

/// Joins the plans of all sections into the plan of the whole drive, for fill() and finish(). Throws InputError that names the
/// sections that are missing, or were planned by another program or with other options.
PlanReport join(const job::Job& job, Progress& progress);

/// The numbers of frames of a fill.
struct FillReport {
  std::size_t frames = 0;  ///< in the range
  std::size_t filled = 0;  ///< filled by this call; the others were finished
};

/// Fills the unfinished frames of a range; of the whole drive if `range` is none. `job` is OUT/dvi.toml as written by plan().
/// Throws InputError if job.out does not contain its plan, if the plan was made by another program or from other files, or if
/// no frame is in the range.
FillReport fill(const job::Job& job, const std::optional<FrameRange>& range, Progress& progress);

/// Writes all files other than the frames. Throws InputError, with their numbers, if frames are missing.
result::RunReport finish(const job::Job& job, Progress& progress);

}  // namespace dvi::run
