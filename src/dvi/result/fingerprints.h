#pragma once

#include <string>

#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"

namespace dvi::result {

/// Which drives a result is of; a folder made from others is refused.
std::string identity_of(const inputs::Recordings& drives);

/// Of this build: another may make other pixels.
std::string program_fingerprint();

/// Of name and size of every file that is read: tells most changes without reading them.
std::string listing_of(const inputs::Recordings& drives);

/// Of the program and of every file that is read, wherever they lie. Reads them all.
std::string content_of(const inputs::Recordings& drives);

/// Of all that the frames depend on; `content` is content_of() the drives.
std::string fingerprint_of(job::Job job, const std::string& content);

/// Of all that the stages before the fill depend on: not of what only the fill is told, nor of the names of what `content` is
/// of.
std::string stages_fingerprint_of(job::Job job, const std::string& content);

}  // namespace dvi::result
