#pragma once

#include "dvi/core/progress.h"
#include "dvi/exports/result.h"

namespace dvi::exports {

/// Makes a folder, with a subfolder for each camera if the result has several.
void make_folders_of_cameras(const Result& result, const fs::path& folder);

/// Writes the files that the formats for scene reconstruction share: images/NAME.png, the clean frames, and masks/NAME +
/// `mask_ending` (images/CAMERA/NAME.png and so on if there are several cameras), which is 0 for unobserved pixels
/// (interpolated, synthesized, empty, imported) and 255 elsewhere. Ticks once per frame.
void write_images_and_masks(const Result& result, const fs::path& folder, const std::string& mask_ending, Progress& progress);

/// Copies the bytes of a file. Throws InputError if that fails.
void copy_picture(const fs::path& from, const fs::path& to);

}  // namespace dvi::exports
