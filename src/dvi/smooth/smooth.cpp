#include "dvi/smooth/smooth.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "dvi/drive/view.h"
#include "dvi/image/grey.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/optical_flow.h"
#include "dvi/image/region.h"

namespace dvi::smooth {

using harmonize::FilledFrame, harmonize::Kind;

namespace {

constexpr int kMargin = 64;          // px round the hole in which flow is sought
constexpr float kMostMismatch = 1;   // px between a flow and the flow back
constexpr float kColourSpread = 20;  // grey levels at which a neighbour counts 1/e

/// A box round each part of the hole, those that meet as one.
std::vector<cv::Rect> windows_round(const cv::Mat1b& mask) {
  std::vector<cv::Rect> out;
  for (const cv::Rect& box : part_boxes(mask)) {
    cv::Rect window =
        cv::Rect(box.tl() - cv::Point(kMargin, kMargin), box.br() + cv::Point(kMargin, kMargin)) & cv::Rect({}, mask.size());
    const auto meets = [&](const cv::Rect& other) { return !(other & window).empty(); };
    for (auto other = out.begin(); (other = std::find_if(out.begin(), out.end(), meets)) != out.end(); out.erase(other))
      window |= *other;
    out.push_back(window);
  }
  return out;
}

/// A window of a frame in grey, in the light of another exposure.
cv::Mat1b grey(const FilledFrame& frame, cv::Rect box, const cv::Vec3f& gain) {
  cv::Mat3b bytes;
  cv::multiply(frame.colour(box), cv::Scalar(gain[0], gain[1], gain[2]), bytes, 1, CV_8U);
  return grey_8bit(bytes);
}

/// What smoothing adds up at each pixel of a frame.
struct Sums {
  cv::Mat3f colour;  // weighted
  cv::Mat1f weight;
};

/// A neighbour of a frame in a window of both.
struct Neighbour {
  const FilledFrame& frame;
  cv::Rect box;
  const cv::Mat2f& forth;  // from this frame to the neighbour
  const cv::Mat2f& back;
};

bool is_filled(uchar kind) { return kind != static_cast<uchar>(Kind::empty); }

void add_along_flow(const FilledFrame& frame, const Neighbour& other, Sums& sums) {
  const cv::Mat3f here = frame.colour(other.box), there = other.frame.colour(other.box);
  const cv::Mat1b mask = frame.mask(other.box), kind = frame.kind(other.box), other_kind = other.frame.kind(other.box);
  cv::Mat3f colours = sums.colour(other.box);
  cv::Mat1f weights = sums.weight(other.box);
  const cv::Vec3f gain = gain_to(frame.gain, other.frame.gain);
  const auto right = static_cast<float>(mask.cols - 1), bottom = static_cast<float>(mask.rows - 1);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      if (mask(y, x) == 0 || !is_filled(kind(y, x))) continue;
      const cv::Vec2f& motion = other.forth(y, x);
      const cv::Point2f at(static_cast<float>(x) + motion[0], static_cast<float>(y) + motion[1]);
      if (!(at.x >= 0 && at.y >= 0 && at.x <= right && at.y <= bottom)) continue;
      if (!is_filled(other_kind(cvRound(at.y), cvRound(at.x)))) continue;
      if (cv::norm(motion + bilinear(other.back, at)) >= kMostMismatch) continue;
      const cv::Vec3f colour = bilinear(there, at).mul(gain);
      const double off = cv::norm(colour - here(y, x)) / (std::sqrt(3.0) * kColourSpread);
      const auto weight = static_cast<float>(std::exp(-off * off));
      colours(y, x) += weight * colour;
      weights(y, x) += weight;
    }
}

}  // namespace

FramePair::FramePair(const FilledFrame& first, const FilledFrame& second) : earlier(first), later(second) {
  const cv::Mat1b holes(earlier.mask | later.mask);
  const cv::Vec3f unchanged = cv::Vec3f::all(1), gain = gain_to(earlier.gain, later.gain);
  for (const cv::Rect& box : windows_round(holes)) {
    if (box.width < kLeastFlowSide || box.height < kLeastFlowSide) continue;
    const cv::Mat1b from = grey(earlier, box, unchanged), to = grey(later, box, gain);
    windows.push_back({box, optical_flow(from, to), optical_flow(to, from)});
  }
}

FilledFrame smooth(const FramePair* before, const FilledFrame& frame, const FramePair* after) {
  FilledFrame out = frame;
  if (before == nullptr && after == nullptr) return out;
  Sums sums{frame.colour.clone(), cv::Mat1f(frame.colour.size(), 1.0F)};
  if (before != nullptr)
    for (const FlowWindow& window : before->windows)
      add_along_flow(frame, {before->earlier, window.box, window.backward, window.forward}, sums);
  if (after != nullptr)
    for (const FlowWindow& window : after->windows)
      add_along_flow(frame, {after->later, window.box, window.forward, window.backward}, sums);
  for (int y = 0; y < frame.mask.rows; ++y)
    for (int x = 0; x < frame.mask.cols; ++x)
      if (sums.weight(y, x) > 1) sums.colour(y, x) /= sums.weight(y, x);
  out.colour = sums.colour;
  return out;
}

}  // namespace dvi::smooth
