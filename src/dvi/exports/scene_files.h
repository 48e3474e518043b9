#pragma once

#include "dvi/core/progress.h"
#include "dvi/exports/result.h"

namespace dvi::exports {

/// What the formats of scene reconstruction share: images/NAME.png, the clean frames, and masks/NAME + `mask_ending`, 0 where
/// no frame saw what stands there (interpolated, synthesized, empty) and 255 elsewhere. Ticks once a frame.
void write_images_and_masks(const Result& result, const fs::path& folder, const std::string& mask_ending, Progress& progress);

/// Copies the bytes. InputError where that is impossible.
void copy_picture(const fs::path& from, const fs::path& to);

}  // namespace dvi::exports
