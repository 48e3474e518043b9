#include "dvi/smooth/smooth.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/drive/view.h"
#include "dvi/image/gray.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/optical_flow.h"
#include "dvi/image/region.h"

namespace dvi::smooth {

using harmonize::FilledFrame, harmonize::Kind;

namespace {

constexpr int kMargin = 64;         // px round the hole in which flow is sought
constexpr float kMostMismatch = 1;  // px between a flow and the flow back
constexpr float kColorSpread = 20;  // gray levels at which a neighbor counts 1/e
constexpr float kOutlier = 15;      // gray levels from both neighbors; interpolated texture that is right differs by up to 10

/// A box round each part of the hole, those that meet as one.
std::vector<cv::Rect> windows_round(const cv::Mat1b& mask) {
  std::vector<cv::Rect> out;
  for (const cv::Rect& box : find_part_boxes(mask)) {
    cv::Rect window =
        cv::Rect(box.tl() - cv::Point(kMargin, kMargin), box.br() + cv::Point(kMargin, kMargin)) & cv::Rect({}, mask.size());
    const auto meets = [&](const cv::Rect& other) { return !(other & window).empty(); };
    for (auto other = out.begin(); (other = std::find_if(out.begin(), out.end(), meets)) != out.end(); out.erase(other))
      window |= *other;
    out.push_back(window);
  }
  return out;
}

/// A window of a frame in gray, in the light of another exposure.
cv::Mat1b gray(const FilledFrame& frame, cv::Rect box, const cv::Vec3f& gain) {
  cv::Mat3b bytes;
  cv::multiply(frame.color(box), cv::Scalar(gain[0], gain[1], gain[2]), bytes, 1, CV_8U);
  return gray_8bit(bytes);
}

/// How far the flow from a pixel to a neighboring frame is believed.
enum class Found : std::uint8_t { no, doubtful, surely };

/// What a neighboring frame shows of each pixel, in this frame's light.
struct Shown {
  cv::Mat3f color;
  cv::Mat1b found;  // Found

  Found found_at(cv::Point p) const { return found.empty() ? Found::no : static_cast<Found>(found(p)); }
};

/// A neighbor of a frame in a window of both.
struct Neighbor {
  const FilledFrame& frame;
  cv::Rect box;
  const cv::Mat2f& forth;  // from this frame to the neighbor
  const cv::Mat2f& back;
};

bool is_filled(uchar kind) { return kind != static_cast<uchar>(Kind::empty); }

/// Where the flow finds each pixel of a box in the neighbor's.
cv::Mat2f targets_of(const cv::Mat2f& flow) {
  cv::Mat2f out(flow.size());
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x) out(y, x) = flow(y, x) + cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
  return out;
}

/// Cubic, because a mean of what bilinear interpolation gives is blurred; kept within the nearest 3x3 pixels, so that nothing
/// overshoots at edges.
cv::Mat3f interpolated(const cv::Mat3f& image, const cv::Mat2f& at) {
  const auto looked_up = [&](const cv::Mat& from, int method) {
    cv::Mat out;
    cv::remap(from, out, at, {}, method, cv::BORDER_REPLICATE);
    return out;
  };
  cv::Mat low, high, out;
  cv::erode(image, low, cv::Mat1b(3, 3, uchar{1}));
  cv::dilate(image, high, cv::Mat1b(3, 3, uchar{1}));
  cv::max(looked_up(image, cv::INTER_CUBIC), looked_up(low, cv::INTER_NEAREST), out);
  cv::min(out, looked_up(high, cv::INTER_NEAREST), out);
  return out;
}

/// Gray levels, a mean over the channels.
float difference(const cv::Vec3f& a, const cv::Vec3f& b) {
  return (std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2])) / 3;
}

/// Whether a neighbor, looked up and in this frame's light, looks like this frame round the hole: not where one of both is
/// black or saturated, of which no gain is known.
bool looks_alike(const FilledFrame& frame, const Neighbor& other, const cv::Mat3f& there, const cv::Vec3f& gain) {
  constexpr int kEvery = 4;  // px
  const cv::Mat3f here = frame.color(other.box);
  const cv::Mat1b hole = frame.mask(other.box) | other.frame.mask(other.box);
  std::vector<float> differences;
  for (int y = 0; y < hole.rows; y += kEvery)
    for (int x = 0; x < hole.cols; x += kEvery)
      if (hole(y, x) == 0) differences.push_back(difference(here(y, x), there(y, x).mul(gain)));
  return dvi::median(std::move(differences)) < kColorSpread;
}

void look_along_flow(const FilledFrame& frame, const Neighbor& other, Shown& shown) {
  const cv::Mat1b mask = frame.mask(other.box), kind = frame.kind(other.box), other_kind = other.frame.kind(other.box);
  const cv::Mat2f targets = targets_of(other.forth);
  const cv::Mat3f there = interpolated(other.frame.color(other.box), targets);
  cv::Mat3f colors = shown.color(other.box);
  cv::Mat1b found = shown.found(other.box);
  const cv::Vec3f gain = gain_to(frame.gain, other.frame.gain);
  if (!looks_alike(frame, other, there, gain)) return;
  const auto right = static_cast<float>(mask.cols - 1), bottom = static_cast<float>(mask.rows - 1);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      if (mask(y, x) == 0 || !is_filled(kind(y, x))) continue;
      const cv::Point2f at(targets(y, x));
      if (!(at.x >= 0 && at.y >= 0 && at.x <= right && at.y <= bottom)) continue;
      if (!is_filled(other_kind(cvRound(at.y), cvRound(at.x)))) continue;
      const bool returns = cv::norm(other.forth(y, x) + bilinear(other.back, at)) < kMostMismatch;
      colors(y, x) = there(y, x).mul(gain);
      found(y, x) = static_cast<uchar>(returns ? Found::surely : Found::doubtful);
    }
}

Shown shown_by(const FilledFrame& frame, const FramePair* pair, bool earlier) {
  if (pair == nullptr) return {};
  Shown out{cv::Mat3f(frame.color.size()), cv::Mat1b(frame.color.size(), uchar{0})};
  for (const FlowWindow& window : pair->windows) {
    if (earlier)
      look_along_flow(frame, {pair->earlier, window.box, window.backward, window.forward}, out);
    else
      look_along_flow(frame, {pair->later, window.box, window.forward, window.backward}, out);
  }
  return out;
}

cv::Vec3f median(const cv::Vec3f& a, const cv::Vec3f& b, const cv::Vec3f& c) {
  cv::Vec3f out;
  for (int k = 0; k < 3; ++k) out[k] = std::max(std::min(a[k], b[k]), std::min(std::max(a[k], b[k]), c[k]));
  return out;
}

/// The color of a pixel, or the median of the three frames where it is the odd one out. Where it is, the flow is often in
/// doubt: then it takes two neighbors that agree.
cv::Vec3f outlier_replaced(const cv::Vec3f& here, const Shown& before, const Shown& after, cv::Point p) {
  const Found a = before.found_at(p), b = after.found_at(p);
  if (a == Found::no || b == Found::no) return here;
  const cv::Vec3f &earlier = before.color(p), &later = after.color(p);
  if (difference(here, earlier) < kOutlier || difference(here, later) < kOutlier) return here;
  const bool sure = (a == Found::surely && b == Found::surely) || difference(earlier, later) < kColorSpread;
  return sure ? median(here, earlier, later) : here;
}

}  // namespace

FramePair::FramePair(const FilledFrame& first, const FilledFrame& second) : earlier(first), later(second) {
  const cv::Mat1b holes(earlier.mask | later.mask);
  const cv::Vec3f unchanged = cv::Vec3f::all(1), gain = gain_to(earlier.gain, later.gain);
  for (const cv::Rect& box : windows_round(holes)) {
    if (box.width < kMinFlowSidePx || box.height < kMinFlowSidePx) continue;
    const cv::Mat1b from = gray(earlier, box, unchanged), to = gray(later, box, gain);
    windows.push_back({box, compute_optical_flow(from, to), compute_optical_flow(to, from)});
  }
}

FilledFrame smooth(const FramePair* before, const FilledFrame& frame, const FramePair* after, const SmoothOptions& options) {
  FilledFrame out = frame;
  if (before == nullptr && after == nullptr) return out;
  out.color = frame.color.clone();
  const Shown neighbors[] = {shown_by(frame, before, true), shown_by(frame, after, false)};
  for (int y = 0; y < frame.mask.rows; ++y)
    for (int x = 0; x < frame.mask.cols; ++x) {
      if (frame.mask(y, x) == 0) continue;
      const cv::Point p(x, y);
      cv::Vec3f here = frame.color(p);
      if (options.replace_outliers) here = outlier_replaced(here, neighbors[0], neighbors[1], p);
      cv::Vec3f sum = here;
      float weights = 1;
      for (const Shown& neighbor : neighbors) {
        if (neighbor.found_at(p) != Found::surely) continue;
        const double off = cv::norm(neighbor.color(p) - here) / (std::sqrt(3.0) * kColorSpread);
        const auto weight = static_cast<float>(std::exp(-off * off));
        sum += weight * neighbor.color(p);
        weights += weight;
      }
      out.color(p) = weights > 1 ? sum / weights : here;
    }
  return out;
}

}  // namespace dvi::smooth
