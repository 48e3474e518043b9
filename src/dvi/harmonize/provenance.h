#pragma once

#include <cstddef>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::harmonize {

/// The source of a copied pixel. provenance/NAME.png stores the index of the source + 1 (0: none) in R, x * 16 in G, and y * 16
/// in B; sources_used/NAME.png stores the footprint.
struct Provenance {
  int view = -1;         ///< Index of the source; -1: not copied.
  cv::Point2f position;  ///< Image coordinates in the source.
  cv::Vec2b footprint;   ///< Width and height in source pixels.

  /// Returns the pixel value of FilledFrame::provenance.
  static cv::Vec3w encode(int view, cv::Point2f position);
  /// Decodes the pixel values of FilledFrame::provenance and FilledFrame::used.
  static Provenance decode(const cv::Vec3w& triple, const cv::Vec3b& used);
};

/// Computes the copied color of a pixel before it is harmonized: the mean of the footprint, times the gain to the target,
/// rounded.
cv::Vec3i copy_color(const Views& views, std::size_t target, const cv::Mat3b& source_image, const Provenance& from);

/// The value of an unchanged channel in the images of compute_harmonization().
inline constexpr int kNoChange = 32768;

/// Computes the change of each copied pixel, by which it can be reproduced exactly: `written` minus copy_color(), plus
/// kNoChange, in the channels R, G, B; 0 for pixels that were not copied. `frame` has their provenance.
cv::Mat_<cv::Vec3w> compute_harmonization(const Views& views, std::size_t target, const cv::Mat3b& written,
                                          const FilledFrame& frame);

}  // namespace dvi::harmonize
