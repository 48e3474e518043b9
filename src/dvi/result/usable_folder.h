#pragma once

#include "dvi/job/job.h"

namespace dvi::result {

/// Throws InputError if job.out contains anything but a result of dvi, unless job.force. Changes no file.
void require_usable_folder(const job::Job& job);

/// Throws InputError if job.out is, contains, or is inside of an input of the job. Changes no file.
void require_apart(const job::Job& job);

}  // namespace dvi::result
