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

/// Who wants the frames of a run in memory too. Both may throw, which ends the run.
struct FrameSink {
  /// Before any frame is made: the names of all frames of the target, and which of them will be made, ascending. The others are
  /// finished already.
  std::function<void(const std::vector<std::string>& names, const std::vector<std::size_t>& missing)> begin;
  /// A frame that was made and written. Called from several threads, and not in order.
  result::FinishedFrame finished;
};

/// The main job: the target drive without what its masks cover, into job.out (layout: docs/concepts.md). Goes on from where an
/// interrupted run stopped. InputError, with nothing half-written, where the data or the folder are not usable.
result::RunReport run(const job::Job& job, Progress& progress, const FrameSink& sink = {});

// The same in pieces, which make the same files: plan() once, then fill() for ranges of frames, on any machine that sees the
// drives and job.out under the same paths, in any order, several at once; then finish(). Each may be called again.

/// What a plan is of, for who cuts it into ranges.
struct PlanReport {
  std::vector<int> frames;   ///< by the drive's own numbers, ascending
  std::size_t finished = 0;  ///< of these, by earlier calls
};

/// All that is global: poses, masks, map, exposure, alignment.
PlanReport plan(const job::Job& job, Progress& progress);

struct FillReport {
  std::size_t frames = 0;  ///< in the range
  std::size_t filled = 0;  ///< of these, now; the others were finished
};

/// The frames of a range that are not finished yet; none: all. `job`: OUT/dvi.toml as plan() wrote it. InputError where job.out
/// is no plan of it, or was made by another program or from other files, or no frame lies in the range.
FillReport fill(const job::Job& job, const std::optional<FrameRange>& range, Progress& progress);

/// Everything beside the frames. InputError, which names them, where frames are missing.
result::RunReport finish(const job::Job& job, Progress& progress);

}  // namespace dvi::run
