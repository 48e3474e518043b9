#include "dvi/harmonize/screening.h"

#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/image/color_difference.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

/// Parameters of the screening weights.
struct ScreeningParams {
  float max_weight = 1e-2F;              ///< Differences fade within 10 px; beyond, gains are correct to a few gray levels.
  int max_cell_px = 128;                 ///< Size of the coarsest cells in which differences are averaged.
  int min_cell_px = 8;                   ///< Size of the finest cells.
  float prior_pixels = 4;                ///< Weight of the coarser cell in the mean of a cell.
  std::size_t min_boundary_pixels = 20;  ///< Boundary pixels of a source that suffice for a median difference of its own.
};
constexpr ScreeningParams kScreening;

/// A quantity in gray levels, averaged in cells from coarse to fine. A cell with few values follows the coarser one.
template <class Value>
class Field {
 public:
  explicit Field(cv::Size image)
      : value_((image.height + kScreening.max_cell_px - 1) / kScreening.max_cell_px,
               (image.width + kScreening.max_cell_px - 1) / kScreening.max_cell_px, Value()) {
    start_level();
  }
  /// The value of a cell of the current level, after the last refine() of a pixel.
  const Value& at(cv::Point cell) const { return value_(cell); }
  void add(cv::Point cell, const Value& value, float weight = 1) {
    sum_(cell) += weight * value;
    weight_(cell) += weight;
  }
  /// Completes the level, and starts one with cells, or pixels, that are `times` smaller.
  void refine(int times) {
    for (int y = 0; y < sum_.rows; ++y)
      for (int x = 0; x < sum_.cols; ++x) value_(y, x) = sum_(y, x) / weight_(y, x);
    cv::resize(value_, value_, {}, times, times, cv::INTER_LINEAR);
    start_level();
  }

 private:
  void start_level() {
    sum_ = kScreening.prior_pixels * value_;
    weight_ = cv::Mat1f(value_.size(), kScreening.prior_pixels);
  }

  cv::Mat_<Value> value_, sum_;
  cv::Mat1f weight_;
};

/// The factor from cells of a size to the next finer ones; from the finest cells to pixels.
int refinement_of(int cell_px) { return cell_px > kScreening.min_cell_px ? 2 : kScreening.min_cell_px; }

cv::Vec3f median_difference(const std::vector<BoundaryPixel>& boundary) {
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> values;
    values.reserve(boundary.size());
    for (const BoundaryPixel& pixel : boundary) values.push_back(pixel.difference[c]);
    out[c] = median(std::move(values));
  }
  return out;
}

/// The difference in brightness of the target to each source: the median along the boundary. Sources with few boundary pixels
/// get the median of all.
class SourceOffsets {
 public:
  explicit SourceOffsets(const std::vector<BoundaryPixel>& boundary) : overall_(median_difference(boundary)) {
    std::map<int, std::vector<BoundaryPixel>> of_view;
    for (const BoundaryPixel& pixel : boundary) of_view[pixel.view].push_back(pixel);
    for (const auto& [view, pixels] : of_view)
      if (pixels.size() >= kScreening.min_boundary_pixels) offsets_[view] = median_difference(pixels);
  }
  const cv::Vec3f& of(int view) const {
    const auto found = offsets_.find(view);
    return found == offsets_.end() ? overall_ : found->second;
  }

 private:
  cv::Vec3f overall_;
  std::map<int, cv::Vec3f> offsets_;
};

/// The local difference in brightness of the target to its sources along the boundary, and the spread of it.
struct BoundaryOffsets {
  BoundaryOffsets(const std::vector<BoundaryPixel>& boundary, cv::Size image) : offset(image), spread(image) {
    for (int cell = kScreening.max_cell_px; cell >= kScreening.min_cell_px; cell /= 2) {
      for (const BoundaryPixel& pixel : boundary) {
        const cv::Point at = pixel.at / cell;
        const float off = max_difference(pixel.difference, offset.at(at)) / kSeam.inconsistent_levels;
        spread.add(at, mean_difference(pixel.difference, offset.at(at)));
        offset.add(at, pixel.difference, 1 / (1 + off * off));
      }
      offset.refine(refinement_of(cell));
      spread.refine(refinement_of(cell));
    }
  }

  Field<cv::Vec3f> offset;
  Field<float> spread;
};

/// Averages the contradictions of sources at seams.
Field<float> average_seam_spread(const Copies& copies, const Region& hole) {
  Field<float> out(hole.index.size());
  for (int cell = kScreening.max_cell_px; cell >= kScreening.min_cell_px; cell /= 2) {
    for (std::size_t i = 0; i < hole.size(); ++i)
      for (const Seam& seam : copies.seams[i])
        if (seam.sources == 2) out.add(hole.pixels[i] / cell, seam.spread);
    out.refine(refinement_of(cell));
  }
  return out;
}

}  // namespace

Screening compute_screening(const Copies& copies, const sample::Candidates& candidates, BoundaryModel model) {
  const Region& hole = candidates.hole;
  Screening out{copies.color, std::vector<float>(hole.size(), copies.from_other_drives ? kScreening.max_weight : 0)};
  if (copies.from_other_drives || model == BoundaryModel::published || copies.boundary.empty()) return out;
  const SourceOffsets offsets(copies.boundary);
  std::vector<BoundaryPixel> rest = copies.boundary;
  for (BoundaryPixel& pixel : rest) pixel.difference -= offsets.of(pixel.view);
  const BoundaryOffsets local(rest, hole.index.size());
  const Field<float> seam_spread = average_seam_spread(copies, hole);
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const cv::Point p = hole.pixels[i];
    const float inconsistency = std::pow(local.spread.at(p) / kSeam.inconsistent_levels, 4.0F) +
                                std::pow(seam_spread.at(p) / kSeam.inconsistent_seam_levels, 4.0F);
    out.color[i] += offsets.of(candidates.leading[i].view) + local.offset.at(p);
    out.weight[i] = kScreening.max_weight * inconsistency / (1 + inconsistency);
  }
  return out;
}

}  // namespace dvi::harmonize
