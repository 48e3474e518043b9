#include "dvi/harmonize/limit_colors.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

constexpr int kMarginPx = 40;
constexpr double kTailShare = 0.01;  // pixels at both ends, as of lamps and noise

/// Extends a range by the copies of a pixel and its neighbors, which may be brighter than white before they are limited.
ColorRange extend(ColorRange range, const sample::Candidates& candidates, const std::vector<cv::Vec3f>& copies, cv::Point p) {
  const cv::Mat1i& index = candidates.hole.index;
  for (int y = std::max(p.y - 1, 0); y <= std::min(p.y + 1, index.rows - 1); ++y)
    for (int x = std::max(p.x - 1, 0); x <= std::min(p.x + 1, index.cols - 1); ++x) {
      const int j = index(y, x);
      if (j >= 0 && candidates.leading[j].found()) range = range.with(ColorRange{}.clamp(copies[j]));
    }
  return range;
}

}  // namespace

ColorRange find_range_around(const cv::Mat3b& image, const cv::Mat1b& hole) {
  const cv::Rect within = cv::boundingRect(hole);
  const cv::Rect box =
      cv::Rect(within.x - kMarginPx, within.y - kMarginPx, within.width + 2 * kMarginPx, within.height + 2 * kMarginPx) &
      cv::Rect({}, image.size());
  cv::Mat1b near;
  cv::dilate(hole(box), near, cv::Mat1b(2 * kMarginPx + 1, 2 * kMarginPx + 1, uchar{1}));
  std::array<std::array<std::size_t, 256>, 3> levels{};
  std::size_t count = 0;
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      const cv::Point p = box.tl() + cv::Point(x, y);
      if (near(y, x) == 0 || hole(p) != 0) continue;
      for (int c = 0; c < 3; ++c) ++levels[c][image(p)[c]];
      ++count;
    }
  ColorRange out;
  if (count == 0) return out;
  const auto tail = static_cast<std::size_t>(kTailShare * static_cast<double>(count));
  for (int c = 0; c < 3; ++c) {
    int low = 0, high = 255;
    for (std::size_t passed = levels[c][low]; passed <= tail; passed += levels[c][low]) ++low;
    for (std::size_t passed = levels[c][high]; passed <= tail; passed += levels[c][high]) --high;
    out.low[c] = static_cast<float>(low);
    out.high[c] = static_cast<float>(high);
  }
  return out;
}

void limit_copies(const ColorRange& surroundings, const sample::Candidates& candidates, const std::vector<cv::Vec3f>& copies,
                  cv::Mat3f& color) {
  for (std::size_t i = 0; i < candidates.leading.size(); ++i) {
    if (!candidates.leading[i].found()) continue;
    const cv::Point p = candidates.hole.pixels[i];
    if (surroundings.clamp(color(p)) == color(p)) continue;
    color(p) = extend(surroundings, candidates, copies, p).clamp(color(p));
  }
}

}  // namespace dvi::harmonize
