#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {

/// The counts from which a calibration is computed, for any number of pixels. They are integers, so that the order of additions
/// does not matter.
struct ConfidenceCounts {
  struct Level {
    std::uint64_t pixels = 0, within = 0, error = 0;  ///< error: sum of the differences of the three channels
    Level& operator+=(const Level& other);
  };
  std::array<Level, 256> levels{};                           ///< per confidence
  std::array<std::uint64_t, 3 * 255 + 1> pixels_by_error{};  ///< per error

  void add(std::uint8_t confidence, const cv::Vec3b& result, const cv::Vec3b& truth);
  ConfidenceCounts& operator+=(const ConfidenceCounts& other);
  std::optional<Calibration> compute_calibration() const;  ///< nothing if there are no pixels
};

/// Counts the pixels that `pixels` marks with nonzero values. All images have the same size.
ConfidenceCounts count_confidence(const cv::Mat1b& confidence, const cv::Mat3b& result, const cv::Mat3b& truth,
                                  const cv::Mat1b& pixels);

}  // namespace dvi::metrics
