#pragma once

#include "dvi/core/files.h"
#include "dvi/exports/recorded_input.h"

namespace dvi::commands {

/// Finds the target drive of a finished result by the options in OUT/dvi.toml. Throws InputError if the result is not finished.
exports::RecordedInput find_recorded_input(const fs::path& out);

}  // namespace dvi::commands
