#include "dvi/synthesize/texture_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {
namespace {

/// Parameters of the completion.
struct CompletionParams {
  int cell_px = 4;                 ///< Offsets are compared at this reduced resolution.
  float max_difference = 120;      ///< Sum over the channels, in gray levels; larger differences of two pixels count as this.
  float prior_weight = 1e-3F;      ///< Weight of the prior difference, relative to a known pixel.
  float prior_difference = 60;     ///< Difference where no surroundings can be compared.
  float black_levels = 4;          ///< Added to colors before the logarithm.
  float screening_weight = 1e-4F;  ///< The copies determine the brightness beyond 1 / sqrt(weight), 100 px.
  double solver_tolerance = 1e-3;  ///< Tolerance of the logarithm: a quarter of a gray level at most.
};
constexpr CompletionParams kCompletion;

/// Returns the tile translated by -offset; pixels from outside the tile are unknown.
TextureTile translate(const TextureTile& tile, cv::Point offset) {
  TextureTile out(tile.known.size());
  const cv::Rect all({}, tile.known.size()), to = (all - offset) & all;
  if (to.empty()) return out;
  tile.color(to + offset).copyTo(out.color(to));
  tile.known(to + offset).copyTo(out.known(to));
  return out;
}

/// Reduces the resolution. A pixel is known if all its pixels are.
TextureTile downsample(const TextureTile& tile) {
  constexpr int kCell = kCompletion.cell_px;
  const cv::Size size((tile.known.cols + kCell - 1) / kCell, (tile.known.rows + kCell - 1) / kCell);
  TextureTile out(size);
  cv::resize(tile.color, out.color, size, 0, 0, cv::INTER_AREA);
  cv::Mat1f known, share;
  tile.known.convertTo(known, CV_32F);
  cv::resize(known, share, size, 0, 0, cv::INTER_AREA);
  out.known = cv::Mat1b(share > 254);
  return out;
}

/// Computes the mean difference of two tiles around each pixel.
cv::Mat1f compute_mismatch(const TextureTile& tile, const TextureTile& other, double sigma) {
  const cv::Mat1b both(tile.known & other.known);
  cv::Mat1f off(tile.known.size(), 0.0F), weight(tile.known.size(), 0.0F);
  for (int y = 0; y < off.rows; ++y)
    for (int x = 0; x < off.cols; ++x) {
      if (both(y, x) == 0) continue;
      const cv::Vec3f d = tile.color(y, x) - other.color(y, x);
      off(y, x) = std::min(std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]), kCompletion.max_difference);
      weight(y, x) = 1;
    }
  cv::GaussianBlur(off, off, {}, sigma);
  cv::GaussianBlur(weight, weight, {}, sigma);
  for (int y = 0; y < off.rows; ++y)
    for (int x = 0; x < off.cols; ++x)
      off(y, x) =
          (off(y, x) + kCompletion.prior_weight * kCompletion.prior_difference) / (weight(y, x) + kCompletion.prior_weight);
  return off;
}

/// Computes logarithms of colors, in which a change of illumination is additive.
cv::Mat3f take_logarithms(const cv::Mat3f& color) {
  cv::Mat3f out(color + cv::Scalar::all(kCompletion.black_levels));
  cv::log(out, out);
  return out;
}

/// Blends copies along `offsets` without steps: the ratios of neighbors are those at the positions that they were copied from,
/// and at a seam the mean of both (eq. 5 in logarithms). `taken` is the index of each pixel's offset, or -1.
class SeamBlender {
 public:
  SeamBlender(const TextureTile& before, const cv::Mat1i& taken, const std::vector<cv::Point>& offsets)
      : known_(before.known.clone()), taken_(taken), offsets_(offsets), log_color_(take_logarithms(before.color)) {}

  void blend(TextureTile& tile) const {
    PoissonSystem system{Region(cv::Mat1b(taken_ >= 0)), {}, {}, 1};
    if (system.region.size() == 0) return;
    std::vector<cv::Vec3f> x;
    for (const cv::Point p : system.region.pixels) {
      const cv::Vec3f own = log_color_(p + offsets_[taken_(p)]);
      float diagonal = kCompletion.screening_weight;
      cv::Vec3f right = kCompletion.screening_weight * own;
      for (const cv::Point q : four_neighbors(p)) {
        if (!is_inside(q) || (known_(q) == 0 && taken_(q) < 0)) continue;
        diagonal += 1;
        right += log_ratio(p, q);
        if (known_(q) != 0) right += log_color_(q);
      }
      system.diagonal.push_back(diagonal);
      system.right.push_back(right);
      x.push_back(own);
    }
    solve_poisson(system, x, kCompletion.solver_tolerance);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (int c = 0; c < 3; ++c)
        tile.color(system.region.pixels[i])[c] = std::max(std::exp(x[i][c]) - kCompletion.black_levels, 0.0F);
  }

 private:
  bool is_inside(cv::Point p) const { return cv::Rect({}, known_.size()).contains(p); }

  /// The logarithm of the ratio of p to q: the mean at the offsets of both, as far as it is known; 0 if none is.
  cv::Vec3f log_ratio(cv::Point p, cv::Point q) const {
    cv::Vec3f sum;
    int count = 0;
    for (const int taken : {taken_(p), taken_(q)}) {
      if (taken < 0) continue;
      const cv::Point offset = offsets_[taken];
      if (!is_inside(p + offset) || !is_inside(q + offset) || known_(p + offset) == 0 || known_(q + offset) == 0) continue;
      sum += log_color_(p + offset) - log_color_(q + offset);
      ++count;
    }
    return count == 0 ? sum : sum / count;
  }

  cv::Mat1b known_;
  cv::Mat1i taken_;
  const std::vector<cv::Point>& offsets_;
  cv::Mat3f log_color_;
};

/// Completes unknown pixels by one round of offsets.
void complete_by(TextureTile& tile, const std::vector<cv::Point>& offsets, double sigma_px) {
  const cv::Mat1b missing(tile.known == 0);
  if (cv::countNonZero(missing) == 0) return;
  const TextureTile coarse = downsample(tile);
  cv::Mat1f least(tile.known.size(), std::numeric_limits<float>::max());
  cv::Mat1i taken(tile.known.size(), -1);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const cv::Mat1b usable(translate(tile, offsets[i]).known & missing);
    if (cv::countNonZero(usable) == 0) continue;
    cv::Mat1f cost;
    const TextureTile other = translate(coarse, offsets[i] / kCompletion.cell_px);
    cv::resize(compute_mismatch(coarse, other, sigma_px / kCompletion.cell_px), cost, tile.known.size(), 0, 0,
               cv::INTER_LINEAR);
    const cv::Mat1b better(usable & cv::Mat1b(cost < least));
    cost.copyTo(least, better);
    taken.setTo(static_cast<int>(i), better);
  }
  SeamBlender(tile, taken, offsets).blend(tile);
  tile.known.setTo(255, taken >= 0);
}

}  // namespace

void complete(TextureTile& tile, const std::vector<std::vector<cv::Point>>& rounds, double sigma_px) {
  for (const std::vector<cv::Point>& offsets : rounds) complete_by(tile, offsets, sigma_px);
}

}  // namespace dvi::synthesize
