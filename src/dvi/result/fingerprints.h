#pragma once

#include <string>

#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"

namespace dvi::result {

/// Returns the paths and cameras of the drives. A folder of other drives is refused.
std::string identity_of(const inputs::Recordings& drives);

/// Returns the hash of this build of the program. Another build may compute other pixels.
std::string program_fingerprint();

/// Returns a fingerprint of the names and sizes of all input files. It detects most changes without reading the files.
std::string listing_of(const inputs::Recordings& drives);

/// Returns a fingerprint of the program and of the contents of all input files, independent of their paths. Reads all files.
std::string content_of(const inputs::Recordings& drives);

/// Returns a fingerprint of everything that the frames depend on: the options, and `content`, the content_of() the drives.
std::string fingerprint_of(job::Job job, const std::string& content);

/// Returns a fingerprint of everything that the stages before the fill depend on. It omits the options of the fill, and the
/// paths of the files in `content`.
std::string stages_fingerprint_of(job::Job job, const std::string& content);

}  // namespace dvi::result
