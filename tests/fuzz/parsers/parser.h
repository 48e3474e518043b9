#pragma once

#include <string>

#include "dvi/core/files.h"

namespace dvi::fuzz {

/// What each target defines: writes the bytes into a folder of its own, where its reader looks for them, and reads them.
/// InputError and UsageError are answers; any other exception is a finding.
void parse(const fs::path& folder, const std::string& bytes);

/// Writes a file and its folders, without syncing; returns its path.
fs::path put(const fs::path& file, const std::string& bytes);

/// What holds of all that a reader accepts; a finding where it does not.
void require(bool holds, const char* what);

/// The images and scans of a drive of two frames, "1" and "2", where they are not yet there. Of each image only the header,
/// 8x6 pixels: readers of drives look at no more.
void put_two_frames(const fs::path& images, const fs::path& scans);

}  // namespace dvi::fuzz
