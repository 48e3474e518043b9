#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::media {

/// Reads the EXIF orientation (1 to 8) of a PNG or JPEG file, 1 if it carries none. Looks at the headers only.
int read_exif_orientation(const fs::path& file);

/// Describes what viewers do for an EXIF orientation: "turn the picture by 180 degrees".
std::string describe_orientation(int exif_orientation);

/// Warns if images have an EXIF orientation, which is applied neither to images nor to masks. Looks at a sample of the files.
void warn_of_image_orientation(Drive& drive);

/// The same for masks of which `sample` are some.
void warn_of_mask_orientation(Drive& drive, const std::vector<fs::path>& sample);

/// Describes that a video's rotation is not applied, and what to do.
std::string describe_video_rotation(const fs::path& video, int rotation_deg);

/// Estimates the bits per pixel of a camera whose images hold values up to `largest`: 8, 10, 12, 14, or 16.
int estimate_value_bits(int largest);

/// Determines how many bits the values of 16-bit images use, from the largest value in a sample of the files: 8, 10, 12, 14 or
/// 16. Cameras of 12 bits often store their values as they are, and all images of a drive must be scaled alike. Returns 16 for
/// images of 8 bits, and if nothing tells; warns of anything else.
int find_value_bits(Drive& drive);

/// Reads an image as read_image() does, but scales those of 16 bits from the bits that find_value_bits() determined. Throws
/// InputError also if a value needs more bits.
cv::Mat3b read_scaled_image(const fs::path& file, cv::Size size, int value_bits);

}  // namespace dvi::media
