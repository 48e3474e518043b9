#include "dvi/synthesize/exemplar_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace dvi::synthesize {
namespace {

/// Computes derivatives of the ground position by central differences; NaN beside pixels that are not on the ground.
cv::Mat4f derive(const cv::Mat2f& ground) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  cv::Mat4f out(ground.size(), cv::Vec4f(kNan, kNan, kNan, kNan));
  for (int y = 0; y < ground.rows; ++y)
    for (int x = 0; x < ground.cols; ++x) {
      const int x0 = std::max(x - 1, 0), x1 = std::min(x + 1, ground.cols - 1), y0 = std::max(y - 1, 0),
                y1 = std::min(y + 1, ground.rows - 1);
      if (x0 == x1 || y0 == y1) continue;
      const cv::Vec2f dx = (ground(y, x1) - ground(y, x0)) / static_cast<float>(x1 - x0),
                      dy = (ground(y1, x) - ground(y0, x)) / static_cast<float>(y1 - y0);
      out(y, x) = {dx[0], dx[1], dy[0], dy[1]};
    }
  return out;
}

}  // namespace

void derive_level(ExemplarLevel& level) {
  level.slope = derive(level.ground);
  for (int y = 0; y < level.ground.rows; ++y)
    for (int x = 0; x < level.ground.cols; ++x)
      if (std::isnan(level.slope(y, x)[0] + level.slope(y, x)[1] + level.slope(y, x)[2] + level.slope(y, x)[3]))
        level.ground(y, x)[0] = std::numeric_limits<float>::quiet_NaN();
  cv::Mat1b framed;
  cv::copyMakeBorder(level.usable, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
  cv::Mat1f distance;
  cv::distanceTransform(framed, distance, cv::DIST_C, 3);
  level.clearance = cv::Mat1f(distance(cv::Rect(1, 1, level.usable.cols, level.usable.rows)) - 1);
}

ExemplarLevel halve(const ExemplarLevel& fine) {
  ExemplarLevel out;
  out.scale = 2 * fine.scale;
  const cv::Size size((fine.size().width + 1) / 2, (fine.size().height + 1) / 2);
  cv::resize(fine.prior, out.prior, size, 0, 0, cv::INTER_AREA);
  out.color = cv::Mat4f(size, cv::Vec4f());
  out.unknown = cv::Mat1b(size, uchar{0});
  out.usable = cv::Mat1b(size, uchar{0});
  out.group = cv::Mat1b(size, uchar{0});
  out.ground = cv::Mat2f(size, cv::Vec2f());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      cv::Vec4f known_sum, sum;
      cv::Vec2f ground;
      int known = 0, usable = 0, count = 0, on_ground = 0;
      std::array<int, 256> groups{};
      uchar group = 0;
      for (int j = 2 * y; j < std::min(2 * y + 2, fine.size().height); ++j)
        for (int i = 2 * x; i < std::min(2 * x + 2, fine.size().width); ++i) {
          ++count;
          sum += fine.color(j, i);
          if (fine.unknown(j, i) == 0) ++known, known_sum += fine.color(j, i);
          if (fine.usable(j, i) != 0) ++usable;
          if (fine.is_ground({i, j})) ++on_ground, ground += fine.ground(j, i);
          if (++groups[fine.group(j, i)] > groups[group]) group = fine.group(j, i);
        }
      const bool is_known = 2 * known >= count;
      out.color(y, x) = is_known ? known_sum / static_cast<float>(known) : sum / static_cast<float>(count);
      out.unknown(y, x) = is_known ? 0 : 255;
      out.usable(y, x) = 2 * usable > count && is_known ? 255 : 0;
      out.group(y, x) = group;
      out.ground(y, x) =
          on_ground == count ? ground / static_cast<float>(count) : cv::Vec2f::all(std::numeric_limits<float>::quiet_NaN());
    }
  derive_level(out);
  return out;
}

}  // namespace dvi::synthesize
