#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::result {

/// Where the truth of a result is, to show beside it; empty: there is none.
struct ShownTruth {
  fs::path folder;         ///< NAME.png
  std::string evaluation;  ///< metrics::Evaluation as JSON
};

/// Notes what the report's files of a frame are: written after them.
void list_report_frame(const fs::path& out, const std::string& name, std::size_t number, const std::string& fingerprint);

/// OUT/report.html and OUT/report/ of a run's result. `report_json` is asked for once all else is written. Files of frames that
/// list_report_frame() noted with this fingerprint are kept.
void write_report(const job::Job& job, const std::vector<std::string>& names, const std::string& fingerprint,
                  const std::function<std::string()>& report_json, const Tick& tick);

/// The same of a result on disk, however whole it is: what is missing is said in the report. InputError where `out` is no
/// result of dvi or cannot be written.
void write_report(const fs::path& out, const ShownTruth& truth, Progress& progress);

/// Whether the report of a result is there as it was written.
bool is_report_whole(const fs::path& out);

/// The same for who scores a result: nothing where `out` is not of dvi run, a warning where it cannot be written.
void show_truth(const fs::path& out, const ShownTruth& truth, Progress& progress);

}  // namespace dvi::result
