#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::result {

/// The truth that the report shows beside a result; empty for none.
struct ShownTruth {
  fs::path folder;         ///< with NAME.png per frame
  std::string evaluation;  ///< metrics::Evaluation as JSON
};

/// Writes the manifest of the report's files of a frame, after these files.
void write_report_frame_manifest(const fs::path& out, const std::string& name, std::size_t number,
                                 const std::string& fingerprint);

/// Removes this manifest, before a picture of the frame is changed.
void remove_report_frame_manifest(const fs::path& out, const std::string& name);

/// The frames of a run, and the fingerprint in the manifests of their files.
struct ReportedFrames {
  const std::vector<std::string>& names;
  const std::string& fingerprint;
};

/// Writes OUT/report.html and OUT/report/ of a run. `report_json` is called after all other files are written. Files of frames
/// that have a manifest with the fingerprint are kept.
void write_report(const job::Job& job, const ReportedFrames& frames, const std::function<std::string()>& report_json,
                  const Tick& tick);

/// Writes the report of a result on disk, which may be incomplete: the report lists the missing parts. Throws InputError if
/// `out` is not a result of dvi, or is read-only.
void write_report(const fs::path& out, const ShownTruth& truth, Progress& progress);

/// Whether the report of a result exists and is unchanged.
bool is_report_complete(const fs::path& out);

/// Writes the report of a result with its truth after the result was scored. Does nothing if `out` was not written by dvi run,
/// and warns if it is read-only.
void show_truth(const fs::path& out, const ShownTruth& truth, Progress& progress);

}  // namespace dvi::result
