#pragma once

#include "dvi/exports/exporter.h"

namespace dvi::exports {

/// The remedy for a recording that differs from the one that the run read.
inline constexpr const char* kSameRecording =
    "give the recording of the run as it was (--input PATH), or run again into another folder";

/// Returns the recording of a result, or the one that the user names instead. Throws InputError if it does not exist.
RecordedInput find_input(const Result& result, const ExportOptions& options);

/// Throws InputError if the place of an export is in the recording.
void require_outside(const fs::path& place, const fs::path& recording);

}  // namespace dvi::exports
