#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {

/// All that calibration needs to know of any number of pixels, in whole numbers: they may be added in any order.
struct ConfidenceCounts {
  struct Level {
    std::uint64_t pixels = 0, within = 0, error = 0;  ///< error: sum of the three channels' differences
    Level& operator+=(const Level& other);
  };
  std::array<Level, 256> levels{};                     ///< by confidence
  std::array<std::uint64_t, 3 * 255 + 1> pixels_of{};  ///< by error

  void add(std::uint8_t confidence, const cv::Vec3b& result, const cv::Vec3b& truth);
  ConfidenceCounts& operator+=(const ConfidenceCounts& other);
  std::optional<Calibration> calibration() const;  ///< none of no pixels
};

ConfidenceCounts count_confidence(const cv::Mat1b& confidence, const cv::Mat3b& result, const cv::Mat3b& truth,
                                  const cv::Mat1b& pixels);

}  // namespace dvi::metrics
