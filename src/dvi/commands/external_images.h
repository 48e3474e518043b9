#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::commands {

/// Assigns the images of a folder to frames: by their names (NAME, or NAME_mask with digits), or, if no image has the name of a
/// frame, in natural order. `needed` states for each name whether the frame needs an image; others get none if images are
/// assigned by name. Throws InputError if an image is missing, if a frame has two, if only some images have the name of a
/// frame, or if the numbers differ.
std::vector<std::optional<fs::path>> assign_images(const fs::path& folder, const std::vector<std::string>& names,
                                                   const std::vector<char>& needed);

/// Throws InputError unless a file is an 8-bit color image of this size.
void require_color_image(const fs::path& file, cv::Size size);

/// The mean absolute difference of an image to a frame at the frame's observed pixels, in gray levels.
struct ObservedDifference {
  double same = 0;     ///< as the image is
  double swapped = 0;  ///< with red and blue swapped
};

/// Compares an image with a frame at the pixels that are not in `hole`; zeros if there are none.
ObservedDifference compare_observed(const cv::Mat3b& image, const cv::Mat3b& frame, const cv::Mat1b& hole);

/// Throws InputError if an image does not show its frame.
void require_same_scene(const fs::path& file, const ObservedDifference& difference);

/// Throws InputError if the images of a folder have red and blue swapped, by the mean of their differences.
void require_color_order(const fs::path& folder, const std::vector<ObservedDifference>& differences);

}  // namespace dvi::commands
