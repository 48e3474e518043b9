#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/map/static_map.h"
#include "dvi/pipeline/cpu_clock.h"
#include "dvi/pipeline/fill.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/result_folder.h"

namespace dvi::pipeline {

/// The report of this very run, if its folder holds all of it already.
std::optional<std::string> finished_report(const Job& job, const std::vector<OpenDrive>& drives, Progress& progress);

/// What a run leaves: the frames of the target in its folder, and all that is told of them.
class RunResult {
 public:
  /// Takes up what a run of the same drives and options has finished. InputError where the folder is refused.
  RunResult(const Job& job, const std::vector<OpenDrive>& drives, const Views& views, Progress& progress);

  /// Makes the frames that are not finished yet, block by block, smooths them (stage 9) and writes each with its record.
  void make_frames(const FillFrame& fill_frame, const align::Alignment& alignment, CpuClock& clock);

  /// Writes what stands beside the frames, the report last, and returns that. A baseline has no map: null.
  std::string complete(const map::StaticMap* map, const align::Alignment& alignment, const CpuClock& clock);

 private:
  const Job& job_;
  const std::vector<OpenDrive>& drives_;
  const Views& views_;
  Progress& progress_;
  std::vector<std::string> names_;  // of the frames, as the target's views
  ResultFolder folder_;
  std::vector<std::size_t> open_;  // views that are to be made
};

}  // namespace dvi::pipeline
