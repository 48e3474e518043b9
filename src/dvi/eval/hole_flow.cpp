#include "dvi/eval/hole_flow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "dvi/harmonize/poisson.h"
#include "dvi/image/region.h"

namespace dvi {
namespace {

constexpr int kStep = 2;        // px between grid points
constexpr int kMargin = 8;      // px: the reach of DIS' patches, within which what is masked spoils the flow
constexpr int kLeastSide = 32;  // px; DIS needs some pyramid

cv::Mat1b grey(const cv::Mat3b& image) {
  cv::Mat1b out;
  cv::cvtColor(image, out, cv::COLOR_BGR2GRAY);
  return out;
}

template <class Pixel>
cv::Mat_<Pixel> every_second(const cv::Mat_<Pixel>& image) {
  cv::Mat_<Pixel> out((image.rows + kStep - 1) / kStep, (image.cols + kStep - 1) / kStep);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out(y, x) = image(kStep * y, kStep * x);
  return out;
}

cv::Mat2f grid_flow(const cv::Mat1b& from, const cv::Mat1b& to) {
  cv::Mat2f flow;
  cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)->calc(from, to, flow);
  return every_second(flow);
}

/// Replaces the flow in the region by the harmonic function of what is around it.
void complete(const Region& region, cv::Mat2f& flow) {
  const cv::Rect grid({}, flow.size());
  PoissonSystem laplace{region, {}, {}};
  for (const cv::Point p : region.pixels) {
    float neighbours = 0;
    cv::Vec3f fixed;
    for (const cv::Point q : {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)}) {
      if (!grid.contains(q)) continue;
      neighbours += 1;
      if (region.index(q) < 0) fixed += cv::Vec3f(flow(q)[0], flow(q)[1], 0);
    }
    laplace.diagonal.push_back(neighbours);
    laplace.right.push_back(fixed);
  }
  std::vector<cv::Vec3f> x(region.size());
  solve(laplace, x);
  for (std::size_t i = 0; i < x.size(); ++i) flow(region.pixels[i]) = {x[i][0], x[i][1]};
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
  const Region region(spoilt);
  if (region.size() == spoilt.total() || std::min(first.cols, first.rows) < kLeastSide) return unknown(spoilt.size());
  const cv::Mat1b from = grey(first), to = grey(second);
  HoleFlow flow{grid_flow(from, to), grid_flow(to, from)};
  complete(region, flow.forth);
  complete(region, flow.back);
  HoleFlow trusted{flow.forth.clone(), flow.back.clone()};
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < spoilt.rows; ++y)
    for (int x = 0; x < spoilt.cols; ++x) {
      if (!consistent(flow.forth, flow.back, {x, y}, consistency_px)) trusted.forth(y, x) = {kNaN, kNaN};
      if (!consistent(flow.back, flow.forth, {x, y}, consistency_px)) trusted.back(y, x) = {kNaN, kNaN};
    }
  return trusted;
}

}  // namespace dvi
