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

constexpr int kStep = 2;               // px between grid points
constexpr int kMargin = 8;             // px: the reach of DIS' patches, within which what is masked spoils the flow
constexpr int kBand = 8;               // grid points around the masks whose flow is continued into them
constexpr double kSpring = 1 / 256.0;  // against bending: noise finer than 4 grid points is evened out

template <class Pixel>
cv::Mat_<Pixel> every_second(const cv::Mat_<Pixel>& image) {
  cv::Mat_<Pixel> out((image.rows + kStep - 1) / kStep, (image.cols + kStep - 1) / kStep);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out(y, x) = image(kStep * y, kStep * x);
  return out;
}

/// Grid points, as steps from a first one, whose weighted sum is a second derivative.
using Stencil = std::vector<std::pair<cv::Point, double>>;

const std::vector<Stencil>& second_derivatives() {
  static const double twice = std::sqrt(2.0);  // the mixed one counts twice
  static const std::vector<Stencil> stencils = {{{{0, 0}, 1}, {{1, 0}, -2}, {{2, 0}, 1}},
                                                {{{0, 0}, 1}, {{0, 1}, -2}, {{0, 2}, 1}},
                                                {{{0, 0}, twice}, {{1, 0}, -twice}, {{0, 1}, -twice}, {{1, 1}, twice}}};
  return stencils;
}

/// Replaces the flow in the region by the thin plate through what is around it: of all continuations the one with the least
/// sum of squared second derivatives, within `kBand` of the region drawn to the flow by springs only, which evens out its
/// noise before it is continued. It continues the flow of a plane, which is quadratic in the position, as it is.
void complete(const cv::Mat1b& spoilt, HoleFlow& flow) {
  constexpr double kStiff = 1e-6;  // a solution even where what is around lies on one line
  const cv::Rect grid({}, spoilt.size());
  const Region region(grown(spoilt, kBand));
  const auto size = static_cast<Eigen::Index>(region.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX4d right = Eigen::MatrixX4d::Zero(size, 4);
  for (Eigen::Index i = 0; i < size; ++i) {
    const cv::Point p = region.pixels[static_cast<std::size_t>(i)];
    entries.emplace_back(i, i, spoilt(p) != 0 ? kStiff : kSpring);
    const cv::Vec2f &forth = flow.forth(p), &back = flow.back(p);
    if (spoilt(p) == 0) right.row(i) = kSpring * Eigen::RowVector4d(forth[0], forth[1], back[0], back[1]);
  }
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x)
      for (const Stencil& stencil : second_derivatives()) {
        if (!grid.contains(cv::Point(x, y) + stencil.back().first)) continue;
        Eigen::RowVector4d known = Eigen::RowVector4d::Zero();
        for (const auto& [step, weight] : stencil) {
          const cv::Point p = cv::Point(x, y) + step;
          const cv::Vec2f &forth = flow.forth(p), &back = flow.back(p);
          if (region.index(p) < 0) known += weight * Eigen::RowVector4d(forth[0], forth[1], back[0], back[1]);
        }
        for (const auto& [step, weight] : stencil) {
          const int i = region.index(cv::Point(x, y) + step);
          if (i < 0) continue;
          right.row(i) -= weight * known;
          for (const auto& [other, its_weight] : stencil)
            if (const int j = region.index(cv::Point(x, y) + other); j >= 0) entries.emplace_back(i, j, weight * its_weight);
        }
      }
  const Eigen::MatrixX4d plate = solve_normal_equations(entries, right);
  for (Eigen::Index i = 0; i < size; ++i) {
    const cv::Point p = region.pixels[static_cast<std::size_t>(i)];
    if (spoilt(p) == 0) continue;
    flow.forth(p) = cv::Vec2d(plate(i, 0), plate(i, 1));
    flow.back(p) = cv::Vec2d(plate(i, 2), plate(i, 3));
  }
}

bool consistent(const cv::Mat2f& forth, const cv::Mat2f& back, cv::Point p, double tolerance) {
  const cv::Vec2f& motion = forth(p);
  const std::optional<cv::Point2f> home = HoleFlow::at(back, cv::Point2f(kStep * p) + cv::Point2f(motion));
  return home && cv::norm(motion + cv::Vec2f(*home)) <= tolerance;
}

// Of a frame without surroundings nothing is known.
HoleFlow unknown(cv::Size grid) {
  const cv::Mat2f nowhere(grid, cv::Vec2f::all(std::numeric_limits<float>::quiet_NaN()));
  return {nowhere, nowhere};
}

}  // namespace

std::optional<cv::Point2f> HoleFlow::at(const cv::Mat2f& flow, cv::Point2f position) {
  const float u = position.x / kStep, v = position.y / kStep;
  if (!(u >= 0 && v >= 0 && u <= static_cast<float>(flow.cols) - 0.5F && v <= static_cast<float>(flow.rows) - 0.5F))
    return std::nullopt;
  const int x = std::min(static_cast<int>(u), flow.cols - 1), x1 = std::min(x + 1, flow.cols - 1);
  const int y = std::min(static_cast<int>(v), flow.rows - 1), y1 = std::min(y + 1, flow.rows - 1);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const cv::Vec2f motion = (flow(y, x) * (1 - a) + flow(y, x1) * a) * (1 - b) + (flow(y1, x) * (1 - a) + flow(y1, x1) * a) * b;
  if (std::isnan(motion[0])) return std::nullopt;
  return cv::Point2f(motion);
}

HoleFlow hole_flow(const cv::Mat3b& first, const cv::Mat1b& first_mask, const cv::Mat3b& second, const cv::Mat1b& second_mask,
                   double consistency_px) {
  cv::Mat1b either;
  cv::bitwise_or(first_mask, second_mask, either);
  const cv::Mat1b spoilt = every_second<uchar>(grown(either, kMargin));
  if (static_cast<std::size_t>(cv::countNonZero(spoilt)) == spoilt.total() || std::min(first.cols, first.rows) < kMinFlowSidePx)
    return unknown(spoilt.size());
  const cv::Mat1b from = gray_8bit(first), to = gray_8bit(second);
  HoleFlow flow{every_second(compute_optical_flow(from, to)), every_second(compute_optical_flow(to, from))};
  complete(spoilt, flow);
  HoleFlow trusted{flow.forth.clone(), flow.back.clone()};
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < spoilt.rows; ++y)
    for (int x = 0; x < spoilt.cols; ++x) {
      if (!consistent(flow.forth, flow.back, {x, y}, consistency_px)) trusted.forth(y, x) = {kNaN, kNaN};
      if (!consistent(flow.back, flow.forth, {x, y}, consistency_px)) trusted.back(y, x) = {kNaN, kNaN};
    }
  return trusted;
}

}  // namespace dvi::baselines
