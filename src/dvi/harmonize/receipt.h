#pragma once

#include <cstddef>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"

namespace dvi {

/// Where a copied pixel comes from, as provenance/NAME.png has it: R source number + 1 (0: nowhere), G x * 16, B y * 16.
struct Provenance {
  int view = -1;
  cv::Point2f position;

  static Provenance of(const cv::Vec3w& triple);
};

/// Colour of a source at a position, bilinear, in the target's light, rounded: the copy before it is harmonised.
cv::Vec3i copied_colour(const Views& views, std::size_t target, const cv::Mat3b& source_image, const Provenance& from);

/// What became of each copied pixel since, so that it can be reproduced exactly: colour written minus copied_colour, +
/// kNoChange, channels R, G, B; 0 where nothing was copied.
inline constexpr int kNoChange = 32768;
cv::Mat_<cv::Vec3w> harmonisation(const Views& views, std::size_t target, const cv::Mat3b& written,
                                  const cv::Mat_<cv::Vec3w>& provenance);

}  // namespace dvi
