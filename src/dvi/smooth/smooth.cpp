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
#include "dvi/image/color_difference.h"
#include "dvi/image/gray.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/optical_flow.h"
#include "dvi/image/region.h"

namespace dvi::smooth {

using harmonize::FilledFrame, harmonize::Kind;

namespace {

/// Returns a box around each part of the hole; overlapping boxes are merged.
std::vector<cv::Rect> find_windows(const cv::Mat1b& mask) {
  std::vector<cv::Rect> out;
  for (const cv::Rect& box : find_part_boxes(mask)) {
    cv::Rect window = cv::Rect(box.tl() - cv::Point(kSmooth.margin_px, kSmooth.margin_px),
                               box.br() + cv::Point(kSmooth.margin_px, kSmooth.margin_px)) &
                      cv::Rect({}, mask.size());
    const auto overlaps = [&](const cv::Rect& other) { return !(other & window).empty(); };
    for (auto other = out.begin(); (other = std::find_if(out.begin(), out.end(), overlaps)) != out.end(); out.erase(other))
      window |= *other;
    out.push_back(window);
  }
  return out;
}

/// Converts colors to gray with a gain.
cv::Mat1b to_gray(const cv::Mat3f& color, const cv::Vec3f& gain) {
  cv::Mat3b bytes;
  cv::multiply(color, cv::Scalar(gain[0], gain[1], gain[2]), bytes, 1, CV_8U);
  return gray_8bit(bytes);
}

/// The reliability of the flow from a pixel to a neighboring frame.
enum class FlowState : std::uint8_t { none, inconsistent, consistent };

/// The colors of a neighboring frame along the flow, in the exposure of this frame.
struct NeighborColors {
  cv::Mat3f color;
  cv::Mat1b state;  // FlowState

  FlowState get_state(cv::Point p) const { return state.empty() ? FlowState::none : static_cast<FlowState>(state(p)); }
};

/// A neighbor of a frame in a box of both.
struct Neighbor {
  const FrameWindow& window;
  const cv::Vec3f& gain;
  cv::Rect box;
  const cv::Mat2f& forward;  // from this frame to the neighbor
  const cv::Mat2f& backward;
};

bool is_filled(uchar kind) { return kind != static_cast<uchar>(Kind::empty); }

/// Computes the position of each pixel of a box in the neighbor.
cv::Mat2f compute_targets(const cv::Mat2f& flow) {
  cv::Mat2f out(flow.size());
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x) out(y, x) = flow(y, x) + cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
  return out;
}

/// Interpolates cubically, because means of bilinear colors are blurred. Colors are clamped to the range of the nearest 3x3
/// pixels, so that edges do not overshoot.
cv::Mat3f interpolate_cubic(const cv::Mat3f& image, const cv::Mat2f& at) {
  const auto remap = [&](const cv::Mat& from, int method) {
    cv::Mat out;
    cv::remap(from, out, at, {}, method, cv::BORDER_REPLICATE);
    return out;
  };
  cv::Mat low, high, out;
  cv::erode(image, low, cv::Mat1b(3, 3, uchar{1}));
  cv::dilate(image, high, cv::Mat1b(3, 3, uchar{1}));
  cv::max(remap(image, cv::INTER_CUBIC), remap(low, cv::INTER_NEAREST), out);
  cv::min(out, remap(high, cv::INTER_NEAREST), out);
  return out;
}

/// Returns whether the colors of a neighbor along the flow, in the exposure of this frame, agree with this frame around the
/// hole. They do not if one frame is black or saturated, so that its gain is unknown.
bool is_similar(const FilledFrame& frame, const Neighbor& other, const cv::Mat3f& there, const cv::Vec3f& gain) {
  const cv::Mat3f here = frame.color(other.box);
  const cv::Mat1b hole(frame.mask(other.box) | other.window.mask);
  std::vector<float> differences;
  for (int y = 0; y < hole.rows; y += kSmooth.comparison_step_px)
    for (int x = 0; x < hole.cols; x += kSmooth.comparison_step_px)
      if (hole(y, x) == 0) differences.push_back(mean_difference(here(y, x), there(y, x).mul(gain)));
  return dvi::median(std::move(differences)) < kSmooth.color_scale;
}

void sample_along_flow(const FilledFrame& frame, const Neighbor& other, NeighborColors& out) {
  const cv::Mat1b mask = frame.mask(other.box), kind = frame.kind(other.box);
  const cv::Mat2f targets = compute_targets(other.forward);
  const cv::Mat3f there = interpolate_cubic(other.window.color, targets);
  cv::Mat3f colors = out.color(other.box);
  cv::Mat1b state = out.state(other.box);
  const cv::Vec3f gain = gain_to(frame.gain, other.gain);
  if (!is_similar(frame, other, there, gain)) return;
  const auto right = static_cast<float>(mask.cols - 1), bottom = static_cast<float>(mask.rows - 1);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      if (mask(y, x) == 0 || !is_filled(kind(y, x))) continue;
      const cv::Point2f at(targets(y, x));
      if (!(at.x >= 0 && at.y >= 0 && at.x <= right && at.y <= bottom)) continue;
      if (!is_filled(other.window.kind(cvRound(at.y), cvRound(at.x)))) continue;
      const bool is_consistent = cv::norm(other.forward(y, x) + bilinear(other.backward, at)) < kSmooth.max_mismatch_px;
      colors(y, x) = there(y, x).mul(gain);
      state(y, x) = static_cast<uchar>(is_consistent ? FlowState::consistent : FlowState::inconsistent);
    }
}

NeighborColors sample_neighbor(const FilledFrame& frame, const FramePair* pair, bool earlier) {
  if (pair == nullptr) return {};
  NeighborColors out{cv::Mat3f(frame.color.size()), cv::Mat1b(frame.color.size(), uchar{0})};
  for (const FlowWindow& window : pair->windows) {
    if (earlier)
      sample_along_flow(frame, {window.earlier, pair->earlier_gain, window.box, window.backward, window.forward}, out);
    else
      sample_along_flow(frame, {window.later, pair->later_gain, window.box, window.forward, window.backward}, out);
  }
  return out;
}

cv::Vec3f median(const cv::Vec3f& a, const cv::Vec3f& b, const cv::Vec3f& c) {
  cv::Vec3f out;
  for (int k = 0; k < 3; ++k) out[k] = std::max(std::min(a[k], b[k]), std::min(std::max(a[k], b[k]), c[k]));
  return out;
}

/// Returns the color of a pixel, or the median of the three frames if it is an outlier. The flow at outliers is often
/// inconsistent; then the two neighbors must agree.
cv::Vec3f replace_outlier(const cv::Vec3f& here, const NeighborColors& before, const NeighborColors& after, cv::Point p) {
  const FlowState a = before.get_state(p), b = after.get_state(p);
  if (a == FlowState::none || b == FlowState::none) return here;
  const cv::Vec3f &earlier = before.color(p), &later = after.color(p);
  if (mean_difference(here, earlier) < kSmooth.min_outlier || mean_difference(here, later) < kSmooth.min_outlier) return here;
  const bool is_certain =
      (a == FlowState::consistent && b == FlowState::consistent) || mean_difference(earlier, later) < kSmooth.color_scale;
  return is_certain ? median(here, earlier, later) : here;
}

}  // namespace

FramePair::FramePair(const FilledFrame& earlier, const FilledFrame& later)
    : earlier_gain(earlier.gain), later_gain(later.gain) {
  const cv::Mat1b holes(earlier.mask | later.mask);
  const cv::Vec3f unchanged = cv::Vec3f::all(1), gain = gain_to(earlier.gain, later.gain);
  for (const cv::Rect& box : find_windows(holes)) {
    if (box.width < kMinFlowSidePx || box.height < kMinFlowSidePx) continue;
    const cv::Mat1b from = to_gray(earlier.color(box), unchanged), to = to_gray(later.color(box), gain);
    windows.push_back({box, {earlier, box}, {later, box}, compute_optical_flow(from, to), compute_optical_flow(to, from)});
  }
}

FilledFrame smooth(const FramePair* before, const FilledFrame& frame, const FramePair* after, const SmoothOptions& options) {
  FilledFrame out = frame;
  if (before == nullptr && after == nullptr) return out;
  out.color = frame.color.clone();
  const NeighborColors neighbors[] = {sample_neighbor(frame, before, true), sample_neighbor(frame, after, false)};
  for (int y = 0; y < frame.mask.rows; ++y)
    for (int x = 0; x < frame.mask.cols; ++x) {
      if (frame.mask(y, x) == 0) continue;
      const cv::Point p(x, y);
      cv::Vec3f here = frame.color(p);
      if (options.replace_outliers) here = replace_outlier(here, neighbors[0], neighbors[1], p);
      cv::Vec3f sum = here;
      float weights = 1;
      for (const NeighborColors& neighbor : neighbors) {
        if (neighbor.get_state(p) != FlowState::consistent) continue;
        const double off = cv::norm(neighbor.color(p) - here) / (std::sqrt(3.0) * kSmooth.color_scale);
        const auto weight = static_cast<float>(std::exp(-off * off));
        sum += weight * neighbor.color(p);
        weights += weight;
      }
      out.color(p) = weights > 1 ? sum / weights : here;
    }
  return out;
}

}  // namespace dvi::smooth
