#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::media {

/// Reads the EXIF orientation (1 to 8) of a PNG or JPEG file from its headers; 1 if it has none.
int read_exif_orientation(const fs::path& file);

/// Describes how viewers apply an EXIF orientation: "rotate the image by 180 degrees".
std::string describe_orientation(int exif_orientation);

/// Adds a warning if images have an EXIF orientation, which is applied neither to images nor to masks. Inspects a sample of the
/// files.
void warn_of_image_orientation(Drive& drive);

/// Does the same for the masks in `sample`.
void warn_of_mask_orientation(Drive& drive, const std::vector<fs::path>& sample);

/// States that a video's rotation is not applied, and the remedy.
std::string describe_video_rotation(const fs::path& video, int rotation_deg);

/// Estimates the bits per pixel of a camera whose images have values up to `largest`: 8, 10, 12, 14, or 16.
int estimate_value_bits(int largest);

/// Determines the used bits of 16-bit images from the largest value in a sample of the files: 8, 10, 12, 14 or 16. Cameras of
/// 12 bits often store their values unscaled, and all images of a drive must be scaled alike. Returns 16 for 8-bit images, and
/// if the values do not determine it; adds a warning in all other cases.
int find_value_bits(Drive& drive);

/// Reads an image like read_image(), but scales 16-bit images from the bits that find_value_bits() determined. Throws
/// InputError as well if a value needs more bits.
cv::Mat3b read_scaled_image(const fs::path& file, cv::Size size, int value_bits);

}  // namespace dvi::media
