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

/// The images of a cleaned camera, or the scans, in a recording.
struct RecordedPart {
  std::string name;  ///< of the camera or topic
  std::size_t all = 0;
  std::size_t cleaned = 0;  ///< those that the run read
};

/// Warns of images that an export leaves unchanged: others of the cleaned cameras, and those of the cameras or topics `others`.
/// Returns the number of the former.
std::size_t warn_of_traffic(const std::vector<RecordedPart>& images, const std::vector<std::string>& others,
                            Progress& progress);

/// Warns of scans that an export with `--points` leaves unchanged: others of the LiDAR, and those of the topics `others`.
void warn_of_returns(const RecordedPart& scans, const std::vector<std::string>& others, Progress& progress);

}  // namespace dvi::exports
