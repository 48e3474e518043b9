#pragma once

#include "dvi/core/progress.h"
#include "dvi/holdout/holdout.h"
#include "dvi/job/job.h"

namespace dvi::commands {

/// Runs `dvi holdout`: inserts virtual traffic into job.target, and writes the case to job.out. Warns if the drive has neither
/// masks nor labels, because its real traffic then counts as background. Throws InputError if the folder is not empty.
void make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress);

/// Makes the case unless the folder already contains it. Throws InputError if the folder has other contents.
void reuse_or_make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress);

}  // namespace dvi::commands
