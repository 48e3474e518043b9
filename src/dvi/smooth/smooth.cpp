#include "dvi/smooth/smooth.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/grey.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/optical_flow.h"

namespace dvi::smooth {
namespace {

constexpr int kMargin = 64;          // px round the hole in which flow is sought
constexpr float kMostMismatch = 1;   // px between a flow and the flow back
constexpr float kColourSpread = 20;  // grey levels at which a neighbour counts 1/e

cv::Mat1b grey(const cv::Mat3f& colour) {
  cv::Mat3b bytes;
  colour.convertTo(bytes, CV_8UC3);
  return grey_8bit(bytes);
}

/// Weighted colours of the hole's pixels, as another frame shows them along the flow.
struct Sum {
  cv::Mat3f colour;
  cv::Mat1f weight;
};

cv::Mat3f in_light_of(const harmonize::FilledFrame& frame, const harmonize::FilledFrame& other, cv::Rect window) {
  cv::Mat3f out = other.colour(window).clone();
  const cv::Vec3f gain = gain_to(frame.gain, other.gain);
  for (cv::Vec3f& colour : out) colour = colour.mul(gain);
  return out;
}

void add_neighbour(const harmonize::FilledFrame& frame, const harmonize::FilledFrame& other, cv::Rect window, Sum& sum) {
  const cv::Mat3f here = frame.colour(window), there = in_light_of(frame, other, window);
  const cv::Mat1b from = grey(here), to = grey(there), mask = frame.mask(window), kind = frame.kind(window);
  const cv::Mat1b other_kind = other.kind(window);
  const cv::Mat2f forth = optical_flow(from, to), back = optical_flow(to, from);
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x) {
      if (mask(y, x) == 0 || kind(y, x) == static_cast<uchar>(harmonize::Kind::empty)) continue;
      const cv::Vec2f& motion = forth(y, x);
      const cv::Point2f at(static_cast<float>(x) + motion[0], static_cast<float>(y) + motion[1]);
      if (!(at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(window.width - 1) &&
            at.y <= static_cast<float>(window.height - 1)))
        continue;
      if (other_kind(cvRound(at.y), cvRound(at.x)) == static_cast<uchar>(harmonize::Kind::empty)) continue;
      if (cv::norm(motion + bilinear(back, at)) >= kMostMismatch) continue;
      const cv::Vec3f colour = bilinear(there, at);
      const double off = cv::norm(colour - here(y, x)) / (std::sqrt(3.0) * kColourSpread);
      const auto weight = static_cast<float>(std::exp(-off * off));
      sum.colour(y, x) += weight * colour;
      sum.weight(y, x) += weight;
    }
}

cv::Rect grown_box(const cv::Mat1b& mask) {
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) return box;
  const cv::Rect grown(box.x - kMargin, box.y - kMargin, box.width + 2 * kMargin, box.height + 2 * kMargin);
  return grown & cv::Rect({}, mask.size());
}

}  // namespace

harmonize::FilledFrame smooth(const harmonize::FilledFrame* before, const harmonize::FilledFrame& frame,
                              const harmonize::FilledFrame* after, const SmoothOptions& options) {
  harmonize::FilledFrame out = frame;
  if (!options.enabled) return out;
  const cv::Rect window = grown_box(frame.mask);
  if (window.width < kLeastFlowSide || window.height < kLeastFlowSide) return out;
  out.colour = frame.colour.clone();
  Sum sum{frame.colour(window).clone(), cv::Mat1f(window.size(), 1.0F)};
  for (const harmonize::FilledFrame* other : {before, after})
    if (other != nullptr) add_neighbour(frame, *other, window, sum);
  cv::Mat3f inside = out.colour(window);
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x)
      if (sum.weight(y, x) > 1) inside(y, x) = sum.colour(y, x) / sum.weight(y, x);
  return out;
}

}  // namespace dvi::smooth
