#pragma once

#include <cstddef>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"

namespace dvi::harmonize {

/// Where a copied pixel comes from: as provenance/NAME.png has it, R source number + 1 (0: nowhere), G x * 16, B y * 16, and
/// the footprint of sources_used/NAME.png.
struct Provenance {
  int view = -1;
  cv::Point2f position;
  cv::Vec2b footprint;  ///< width, height

  /// `used` as FilledFrame::used.
  static Provenance of(const cv::Vec3w& triple, const cv::Vec3b& used);
};

/// Color of a source over the footprint at a position, in the target's light, rounded: the copy before it is harmonized.
cv::Vec3i copied_color(const Views& views, std::size_t target, const cv::Mat3b& source_image, const Provenance& from);

/// What became of each copied pixel since, so that it can be reproduced exactly: color written minus copied_color, +
/// kNoChange, channels R, G, B; 0 where nothing was copied.
inline constexpr int kNoChange = 32768;
cv::Mat_<cv::Vec3w> harmonization(const Views& views, std::size_t target, const cv::Mat3b& written,
                                  const cv::Mat_<cv::Vec3w>& provenance, const cv::Mat3b& used);

}  // namespace dvi::harmonize
