#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::metrics {

inline constexpr int kTextureScales = 3;        ///< full, half, and quarter resolution
inline constexpr int kTextureOrientations = 4;  ///< of the gradient: horizontal, diagonal, vertical, other diagonal
inline constexpr int kTextureBins = kTextureScales * kTextureOrientations;
inline constexpr int kTextureCellPx = 16;

/// Statistics of the pixels of one set in a cell of kTextureCellPx x kTextureCellPx pixels.
struct TextureCell {
  cv::Point corner;        ///< pixels
  std::size_t pixels = 0;  ///< of the set
  std::array<float, kTextureBins>
      texture{};    ///< log2 of the mean gradient length by scale and orientation, gray levels per pixel
  cv::Vec3f color;  ///< mean, BGR

  /// Returns the mean over the bins.
  float mean_texture() const;
};

/// Computes the cells of an image. `sets` has the number of each pixel's set, 0 for pixels that are left out. Returns the cells
/// of the sets 0 to `set_count` - 1 (none for 0) that have at least a quarter of their pixels in the set, by rows.
std::vector<std::vector<TextureCell>> collect_texture_cells(const cv::Mat3b& image, const cv::Mat1b& sets,
                                                            std::size_t set_count);

}  // namespace dvi::metrics
