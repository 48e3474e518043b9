#include "dvi/metrics/texture_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "dvi/image/gray.h"

namespace dvi::metrics {
namespace {

struct TextureParams {
  double min_share = 0.25;  // share of a cell's pixels in the set
  float noise = 0.25F;      // added to mean gradient lengths, gray levels per pixel: flat surfaces differ by noise only
};
constexpr TextureParams kTexture;

// The sums of a set's pixels in a cell.
struct CellSums {
  std::array<std::size_t, kTextureScales> pixels{};
  std::array<float, kTextureBins> length{};
  cv::Vec3f color;
};

// Returns the orientation of a gradient: 0 along x, 1 along (1, 1), 2 along y, 3 along (1, -1).
int find_orientation(float dx, float dy) {
  constexpr float kTan = 0.41421356F;  // tangent of 22.5 degrees
  if (std::abs(dy) <= kTan * std::abs(dx)) return 0;
  if (std::abs(dx) <= kTan * std::abs(dy)) return 2;
  return (dx > 0) == (dy > 0) ? 1 : 3;
}

class CellGrid {
 public:
  CellGrid(const cv::Mat1b& sets, std::size_t set_count)
      : sets_(sets),
        set_count_(set_count),
        columns_((sets.cols + kTextureCellPx - 1) / kTextureCellPx),
        rows_((sets.rows + kTextureCellPx - 1) / kTextureCellPx),
        sums_(set_count * static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  void add_colors(const cv::Mat3b& image) {
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        if (sets_(y, x) != 0) sum_at(y, x).color += cv::Vec3f(image(y, x));
  }

  // Adds the gradients of a scale, whose image is smaller by 2^scale.
  void add_gradients(const cv::Mat1f& gray, int scale) {
    for (int y = 0; y < gray.rows; ++y)
      for (int x = 0; x < gray.cols; ++x) {
        if (sets_(y << scale, x << scale) == 0) continue;
        const float dx = (gray(y, std::min(x + 1, gray.cols - 1)) - gray(y, std::max(x - 1, 0))) / 2;
        const float dy = (gray(std::min(y + 1, gray.rows - 1), x) - gray(std::max(y - 1, 0), x)) / 2;
        CellSums& sums = sum_at(y << scale, x << scale);
        ++sums.pixels[static_cast<std::size_t>(scale)];
        const int bin = scale * kTextureOrientations + find_orientation(dx, dy);
        sums.length[static_cast<std::size_t>(bin)] += std::sqrt(dx * dx + dy * dy);
      }
  }

  std::vector<std::vector<TextureCell>> finish() const {
    std::vector<std::vector<TextureCell>> cells(set_count_);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const auto cell = static_cast<int>(i / set_count_);
      const cv::Point corner(cell % columns_ * kTextureCellPx, cell / columns_ * kTextureCellPx);
      if (is_large(sums_[i])) cells[i % set_count_].push_back(to_cell(sums_[i], corner));
    }
    return cells;
  }

 private:
  CellSums& sum_at(int y, int x) {
    const int cell = y / kTextureCellPx * columns_ + x / kTextureCellPx;
    return sums_[static_cast<std::size_t>(cell) * set_count_ + sets_(y, x)];
  }

  static bool is_large(const CellSums& sums) {
    return static_cast<double>(sums.pixels[0]) >= kTexture.min_share * kTextureCellPx * kTextureCellPx &&
           *std::min_element(sums.pixels.begin(), sums.pixels.end()) > 0;
  }

  static TextureCell to_cell(const CellSums& sums, cv::Point corner) {
    TextureCell cell{corner, sums.pixels[0], {}, sums.color / static_cast<float>(sums.pixels[0])};
    for (std::size_t bin = 0; bin < cell.texture.size(); ++bin)
      cell.texture[bin] =
          std::log2(sums.length[bin] / static_cast<float>(sums.pixels[bin / kTextureOrientations]) + kTexture.noise);
    return cell;
  }

  const cv::Mat1b& sets_;
  std::size_t set_count_;
  int columns_, rows_;
  std::vector<CellSums> sums_;  // by cell, then by set
};

}  // namespace

float TextureCell::mean_texture() const {
  return std::accumulate(texture.begin(), texture.end(), 0.0F) / static_cast<float>(texture.size());
}

std::vector<std::vector<TextureCell>> collect_texture_cells(const cv::Mat3b& image, const cv::Mat1b& sets,
                                                            std::size_t set_count) {
  CellGrid grid(sets, set_count);
  grid.add_colors(image);
  cv::Mat1f gray;
  gray_8bit(image).convertTo(gray, CV_32F);
  for (int scale = 0; scale < kTextureScales; ++scale) {
    if (scale > 0) {
      cv::Mat1f half;
      cv::pyrDown(gray, half);
      gray = half;
    }
    grid.add_gradients(gray, scale);
  }
  return grid.finish();
}

}  // namespace dvi::metrics
