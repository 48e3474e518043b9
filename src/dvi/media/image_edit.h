#pragma once

#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// New colors of some pixels of a recorded image: those that a run filled.
struct ImageEdit {
  cv::Mat3b colors;      ///< BGR; equal to the recorded image at all pixels that do not change
  cv::Mat1b is_changed;  ///< not 0 where the pixel changes

  /// Returns whether no pixel changes.
  bool is_empty() const;
  /// Returns whether `recorded` is the image that the edit was made for: of its size, and equal at all pixels that do not
  /// change.
  bool matches(const cv::Mat3b& recorded) const;
  /// Writes the new colors into an image of 8-bit gray, BGR, or BGRA (with `is_rgb`, RGB or RGBA). Keeps transparency.
  void apply_to(cv::Mat& image, bool is_rgb = false) const;
};

/// Applies an edit to a PNG or JPEG file and writes it in the same format: a PNG without loss, a JPEG with a quality of 1 to
/// 100. Metadata of the file is kept (text, EXIF, color profiles). If no pixel changes, the file keeps its bytes. Returns
/// nothing if the edit was not made for this image. Throws InputError if the file cannot be decoded, or if its pixels cannot be
/// written back: 16 bits, palettes, gray with transparency, CMYK. `name` is used in messages.
std::optional<std::string> edit_image_file(const fs::path& name, const std::string& file, const ImageEdit& edit,
                                           int jpeg_quality);

}  // namespace dvi::media
