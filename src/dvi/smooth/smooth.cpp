#include "dvi/smooth/smooth.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

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

/// What a frame before or after shows of a window, in this frame's light.
struct Neighbour {
  cv::Mat3f colour;
  cv::Mat1b kind;
  cv::Mat2f forth, back;
};

Neighbour neighbour(const harmonize::FilledFrame& frame, const cv::Mat1b& from, const harmonize::FilledFrame& other,
                    cv::Rect window) {
  Neighbour out{other.colour(window).clone(), other.kind(window), {}, {}};
  const cv::Vec3f gain = gain_to(frame.gain, other.gain);
  for (cv::Vec3f& colour : out.colour) colour = colour.mul(gain);
  const cv::Mat1b to = grey(out.colour);
  out.forth = optical_flow(from, to);
  out.back = optical_flow(to, from);
  return out;
}

/// A colour of a pixel and how much it counts.
struct Weighted {
  cv::Vec3f colour;
  float weight = 0;
};

/// As a neighbour shows the pixel along the flow; nothing where it does not.
Weighted along_flow(const Neighbour& other, cv::Point p, const cv::Vec3f& here) {
  const cv::Vec2f& motion = other.forth(p);
  const cv::Point2f at(static_cast<float>(p.x) + motion[0], static_cast<float>(p.y) + motion[1]);
  if (!(at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(other.kind.cols - 1) &&
        at.y <= static_cast<float>(other.kind.rows - 1)))
    return {};
  if (other.kind(cvRound(at.y), cvRound(at.x)) == static_cast<uchar>(harmonize::Kind::empty)) return {};
  if (cv::norm(motion + bilinear(other.back, at)) >= kMostMismatch) return {};
  const cv::Vec3f colour = bilinear(other.colour, at);
  const double off = cv::norm(colour - here) / (std::sqrt(3.0) * kColourSpread);
  return {colour, static_cast<float>(std::exp(-off * off))};
}

void smooth_window(const harmonize::FilledFrame& frame, std::initializer_list<const harmonize::FilledFrame*> others,
                   cv::Rect window, cv::Mat3f& smoothed) {
  const cv::Mat3f colour = frame.colour(window);
  const cv::Mat1b mask = frame.mask(window), kind = frame.kind(window), from = grey(colour);
  std::vector<Neighbour> neighbours;
  for (const harmonize::FilledFrame* other : others)
    if (other != nullptr) neighbours.push_back(neighbour(frame, from, *other, window));
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x) {
      if (mask(y, x) == 0 || kind(y, x) == static_cast<uchar>(harmonize::Kind::empty)) continue;
      cv::Vec3f sum = colour(y, x);
      float weight = 1;
      for (const Neighbour& other : neighbours) {
        const Weighted shown = along_flow(other, {x, y}, colour(y, x));
        sum += shown.weight * shown.colour;
        weight += shown.weight;
      }
      if (weight > 1) smoothed(window.tl() + cv::Point(x, y)) = sum / weight;
    }
}

/// A box round each part of the hole, those that meet as one.
std::vector<cv::Rect> windows(const cv::Mat1b& mask) {
  cv::Mat1i labels, boxes;
  cv::Mat1d centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, boxes, centres, 8, CV_32S);
  std::vector<cv::Rect> out;
  for (int i = 1; i < count; ++i) {
    const int* box = boxes[i];
    cv::Rect window = cv::Rect(box[cv::CC_STAT_LEFT] - kMargin, box[cv::CC_STAT_TOP] - kMargin,
                               box[cv::CC_STAT_WIDTH] + 2 * kMargin, box[cv::CC_STAT_HEIGHT] + 2 * kMargin) &
                      cv::Rect({}, mask.size());
    const auto meets = [&](const cv::Rect& other) { return !(other & window).empty(); };
    for (auto other = out.begin(); (other = std::find_if(out.begin(), out.end(), meets)) != out.end(); out.erase(other))
      window |= *other;
    out.push_back(window);
  }
  return out;
}

}  // namespace

harmonize::FilledFrame smooth(const harmonize::FilledFrame* before, const harmonize::FilledFrame& frame,
                              const harmonize::FilledFrame* after, const SmoothOptions& options) {
  harmonize::FilledFrame out = frame;
  if (!options.enabled || (before == nullptr && after == nullptr)) return out;
  out.colour = frame.colour.clone();
  for (const cv::Rect window : windows(frame.mask))
    if (window.width >= kLeastFlowSide && window.height >= kLeastFlowSide)
      smooth_window(frame, {before, after}, window, out.colour);
  return out;
}

}  // namespace dvi::smooth
