#include "dvi/baselines/hole_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/geometry/normal_equations.h"
#include "dvi/image/gray.h"
#include "dvi/image/optical_flow.h"
#include "dvi/image/region.h"

namespace dvi::baselines {
namespace {

constexpr int kStepPx = kHoleFlow.step_px;

template <class Pixel>
cv::Mat_<Pixel> subsample(const cv::Mat_<Pixel>& image) {
  cv::Mat_<Pixel> out((image.rows + kStepPx - 1) / kStepPx, (image.cols + kStepPx - 1) / kStepPx);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out(y, x) = image(kStepPx * y, kStepPx * x);
  return out;
}

/// The weights of grid points, relative to a first one, whose weighted sum is a second derivative.
using Stencil = std::vector<std::pair<cv::Point, double>>;

const std::vector<Stencil>& get_second_derivatives() {
  static const double twice = std::sqrt(2.0);  // the mixed one counts twice
  static const std::vector<Stencil> stencils = {{{{0, 0}, 1}, {{1, 0}, -2}, {{2, 0}, 1}},
                                                {{{0, 0}, 1}, {{0, 1}, -2}, {{0, 2}, 1}},
                                                {{{0, 0}, twice}, {{1, 0}, -twice}, {{0, 1}, -twice}, {{1, 1}, twice}}};
  return stencils;
}

/// Replaces the flow in the invalid region by a thin plate: the extrapolation with the smallest sum of squared second
/// derivatives. Within the band around the region, the plate is attached to the flow by a weak data term only, which smooths
/// its noise. The flow of a plane, which is quadratic in the position, is extrapolated exactly.
void extrapolate(const cv::Mat1b& invalid, HoleFlow& flow) {
  constexpr double kRegularization = 1e-6;  // keeps the equations solvable if all surroundings are on one line
  const cv::Rect grid({}, invalid.size());
  const Region region(grown(invalid, kHoleFlow.band));
  const auto size = static_cast<Eigen::Index>(region.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX4d right = Eigen::MatrixX4d::Zero(size, 4);
  for (Eigen::Index i = 0; i < size; ++i) {
    const cv::Point p = region.pixels[static_cast<std::size_t>(i)];
    entries.emplace_back(i, i, invalid(p) != 0 ? kRegularization : kHoleFlow.data_weight);
    const cv::Vec2f &forward = flow.forward(p), &backward = flow.backward(p);
    if (invalid(p) == 0)
      right.row(i) = kHoleFlow.data_weight * Eigen::RowVector4d(forward[0], forward[1], backward[0], backward[1]);
  }
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x)
      for (const Stencil& stencil : get_second_derivatives()) {
        if (!grid.contains(cv::Point(x, y) + stencil.back().first)) continue;
        Eigen::RowVector4d known = Eigen::RowVector4d::Zero();
        for (const auto& [step, weight] : stencil) {
          const cv::Point p = cv::Point(x, y) + step;
          const cv::Vec2f &forward = flow.forward(p), &backward = flow.backward(p);
          if (region.index(p) < 0) known += weight * Eigen::RowVector4d(forward[0], forward[1], backward[0], backward[1]);
        }
        for (const auto& [step, weight] : stencil) {
          const int i = region.index(cv::Point(x, y) + step);
          if (i < 0) continue;
          right.row(i) -= weight * known;
          for (const auto& [other, other_weight] : stencil)
            if (const int j = region.index(cv::Point(x, y) + other); j >= 0) entries.emplace_back(i, j, weight * other_weight);
        }
      }
  const Eigen::MatrixX4d plate = solve_normal_equations(entries, right);
  for (Eigen::Index i = 0; i < size; ++i) {
    const cv::Point p = region.pixels[static_cast<std::size_t>(i)];
    if (invalid(p) == 0) continue;
    flow.forward(p) = cv::Vec2d(plate(i, 0), plate(i, 1));
    flow.backward(p) = cv::Vec2d(plate(i, 2), plate(i, 3));
  }
}

bool is_consistent(const cv::Mat2f& forward, const cv::Mat2f& backward, cv::Point p, double tolerance) {
  const cv::Vec2f& motion = forward(p);
  const std::optional<cv::Point2f> back_motion =
      HoleFlow::interpolate(backward, cv::Point2f(kStepPx * p) + cv::Point2f(motion));
  return back_motion && cv::norm(motion + cv::Vec2f(*back_motion)) <= tolerance;
}

/// Returns a flow without values, for frames without unmasked surroundings.
HoleFlow make_unknown(cv::Size grid) {
  const cv::Mat2f nan(grid, cv::Vec2f::all(std::numeric_limits<float>::quiet_NaN()));
  return {nan, nan};
}

}  // namespace

std::optional<cv::Point2f> HoleFlow::interpolate(const cv::Mat2f& flow, cv::Point2f position) {
  const float u = position.x / kStepPx, v = position.y / kStepPx;
  if (!(u >= 0 && v >= 0 && u <= static_cast<float>(flow.cols) - 0.5F && v <= static_cast<float>(flow.rows) - 0.5F))
    return std::nullopt;
  const int x = std::min(static_cast<int>(u), flow.cols - 1), x1 = std::min(x + 1, flow.cols - 1);
  const int y = std::min(static_cast<int>(v), flow.rows - 1), y1 = std::min(y + 1, flow.rows - 1);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const cv::Vec2f motion = (flow(y, x) * (1 - a) + flow(y, x1) * a) * (1 - b) + (flow(y1, x) * (1 - a) + flow(y1, x1) * a) * b;
  if (std::isnan(motion[0])) return std::nullopt;
  return cv::Point2f(motion);
}

HoleFlow compute_hole_flow(const HoleImage& first, const HoleImage& second, double consistency_px) {
  cv::Mat1b either;
  cv::bitwise_or(first.mask, second.mask, either);
  const cv::Mat1b invalid = subsample<uchar>(grown(either, kHoleFlow.margin_px));
  if (static_cast<std::size_t>(cv::countNonZero(invalid)) == invalid.total() ||
      std::min(first.colors.cols, first.colors.rows) < kMinFlowSidePx)
    return make_unknown(invalid.size());
  const cv::Mat1b from = gray_8bit(first.colors), to = gray_8bit(second.colors);
  HoleFlow flow{subsample(compute_optical_flow(from, to)), subsample(compute_optical_flow(to, from))};
  extrapolate(invalid, flow);
  HoleFlow out{flow.forward.clone(), flow.backward.clone()};
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < invalid.rows; ++y)
    for (int x = 0; x < invalid.cols; ++x) {
      if (!is_consistent(flow.forward, flow.backward, {x, y}, consistency_px)) out.forward(y, x) = {kNaN, kNaN};
      if (!is_consistent(flow.backward, flow.forward, {x, y}, consistency_px)) out.backward(y, x) = {kNaN, kNaN};
    }
  return out;
}

}  // namespace dvi::baselines
