#pragma once

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/metrics/evaluate.h"

namespace dvi::commands {

/// Data of the drive of a result, for scores that need them. Empty paths are left out.
struct DriveTruth {
  fs::path labels = {};  ///< labels with 3D boxes and tracks, instead of those of the run or the drive
  fs::path points = {};  ///< folder of the true labels of points, for score_points() (label_scans.h)
};

/// Scores a result against the truth (metrics::evaluate()), and counts how much of it is filled with removed objects that stay
/// in place (metrics::count_ghosts()). These are the labeled objects of the target with 3D boxes and tracks: the labels that
/// the run removed, or those of the drive, or those of the file `drive.labels`. Where ghosts cannot be counted, the evaluation
/// states the reason. With `drive.points`, also scores the labels of points. Throws InputError as metrics::evaluate() and
/// score_points(), or if `drive.labels` or its drive cannot be read.
metrics::Evaluation evaluate_result(const metrics::EvaluationFolders& folders, const DriveTruth& drive, Progress& progress);

}  // namespace dvi::commands
