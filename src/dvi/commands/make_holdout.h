#pragma once

#include "dvi/core/progress.h"
#include "dvi/holdout/holdout.h"
#include "dvi/job/job.h"

namespace dvi::commands {

/// `dvi holdout`: virtual traffic put into job.target, the case written into job.out. Without masks and labels nothing of the
/// drive counts as real traffic, which is warned of. InputError where the folder is not empty.
void make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress);

/// The same where the folder may hold the very same case already, which is kept. InputError where it holds anything else.
void keep_or_make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress);

}  // namespace dvi::commands
