#pragma once

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/exports/labeled_scans.h"
#include "dvi/metrics/point_scores.h"

namespace dvi::commands {

/// Labels the points of all scans of the target drive of a finished result: finds its objects again with the options of the
/// run, so that they have the numbers of objects.json, and labels their returns (objects::ObjectReturns). Points that are not
/// returns are 0. Throws InputError if the result is not finished or has no poses (baselines), or if its drive has no scans or
/// cannot be read.
exports::LabeledScans label_scans(const fs::path& out, Progress& progress);

/// Scores the labels of label_scans() against a folder with the true labels, NAME.label per scan, in the form of SemanticKITTI.
/// Throws InputError as label_scans(), or if a file of the truth is missing or does not have one label per point of its scan.
metrics::PointScores score_points(const fs::path& out, const fs::path& truth, Progress& progress);

}  // namespace dvi::commands
