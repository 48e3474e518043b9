#include "dvi/synthesize/surrounding_ranges.h"

#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

/// Parameters of the windows.
struct RangeWindowParams {
  int min_radius_px = 8;    ///< Half the width of the smallest window.
  int max_radius_px = 256;  ///< Half the width of the largest window, in which any known pixel suffices.
  /// Share of known pixels in a window: at a straight boundary, a quarter of its width. A few copies do not suffice.
  float known_share = 0.25F;
};
constexpr RangeWindowParams kRangeWindow;

}  // namespace

std::vector<ColorRange> find_surrounding_ranges(const harmonize::FilledFrame& frame, const Region& region) {
  std::vector<ColorRange> out(region.size());
  if (region.size() == 0) return out;
  const cv::Rect all({}, frame.kind.size());
  const cv::Size margin(2 * kRangeWindow.min_radius_px, 2 * kRangeWindow.min_radius_px);
  const cv::Rect box = (cv::boundingRect(region.pixels) + margin - cv::Point(margin / 2)) & all;
  const cv::Mat1b unknown(frame.kind(box) >= static_cast<uchar>(Kind::interpolated));
  cv::Mat1f distance;
  cv::distanceTransform(unknown, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::Mat3b low, high;
  frame.color(box).convertTo(low, CV_8U);
  low.copyTo(high);
  cv::Mat1f known;
  low.setTo(cv::Scalar::all(255), unknown);
  high.setTo(cv::Scalar::all(0), unknown);
  std::vector<uchar> done(region.size(), 0);
  for (int radius = kRangeWindow.min_radius_px, grown_to = 0; radius <= kRangeWindow.max_radius_px; radius *= 2) {
    const int width = 2 * (radius - grown_to) + 1;
    const cv::Mat window = cv::getStructuringElement(cv::MORPH_RECT, {width, width});
    cv::erode(low, low, window);  // successive erosions add up their widths
    cv::dilate(high, high, window);
    grown_to = radius;
    cv::boxFilter(unknown == 0, known, CV_32F, {2 * radius + 1, 2 * radius + 1}, {-1, -1}, true, cv::BORDER_CONSTANT);
    const float enough = radius < kRangeWindow.max_radius_px ? 255 * kRangeWindow.known_share : 1e-3F;
    std::size_t left = 0;
    for (std::size_t i = 0; i < region.size(); ++i) {
      const cv::Point p = region.pixels[i] - box.tl();
      if (done[i] != 0) continue;
      ++left;
      if (2 * distance(p) > static_cast<float>(radius) || known(p) < enough) continue;
      out[i] = {cv::Vec3f(low(p)), cv::Vec3f(high(p))};
      done[i] = 1;
    }
    if (left == 0) break;
  }
  return out;
}

}  // namespace dvi::synthesize
