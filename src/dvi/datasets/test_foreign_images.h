#pragma once

#include "dvi/testing/image_folder.h"  // IWYU pragma: export

namespace dvi::datasets {

/// Images written by ImageMagick, cwebp, ExifTool, and ffmpeg (tests/README.md), of 64 x 48 pixels.
inline const fs::path kForeignImages = fs::path(DVI_TEST_FOREIGN) / "images";

/// A dvi.toml for these images.
inline constexpr const char* kForeignImagesConfig =
    "[camera.front]\nK = [60, 0, 32, 0, 60, 24, 0, 0, 1]\ncamera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, 0]\n";

}  // namespace dvi::datasets
