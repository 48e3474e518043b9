#pragma once

#include "dvi/core/files.h"
#include "dvi/core/progress.h"
#include "dvi/metrics/evaluate.h"

namespace dvi::commands {

/// Scores a result against the truth (metrics::evaluate()), and counts how much of it is filled with removed objects that stay
/// in place (metrics::count_ghosts()). These are the labeled objects of the target with 3D boxes and tracks: the labels that
/// the run removed, or those of the drive, or those of the file `labels` if it is not empty. Where ghosts cannot be counted,
/// the evaluation states the reason. Throws InputError as metrics::evaluate(), or if `labels` or its drive cannot be read.
metrics::Evaluation evaluate_result(const metrics::EvaluationFolders& folders, const fs::path& labels, Progress& progress);

}  // namespace dvi::commands
