#include "dvi/depth/semi_global.h"

#include <algorithm>
#include <array>

namespace dvi::depth {
namespace {

/// Adds one step of a path: the costs of a pixel given those on the path before it (nullptr: it begins here).
void step(const float* cost, const float* before, int labels, float small_step, float large_step, float* path) {
  if (before == nullptr) {
    std::copy(cost, cost + labels, path);
    return;
  }
  const float least = *std::min_element(before, before + labels);
  for (int k = 0; k < labels; ++k) {
    float way = std::min(before[k], least + large_step);
    if (k > 0) way = std::min(way, before[k - 1] + small_step);
    if (k + 1 < labels) way = std::min(way, before[k + 1] + small_step);
    path[k] = cost[k] + way - least;
  }
}

}  // namespace

cv::Mat semi_global(const cv::Mat& cost, const cv::Mat1b& member, float small_step, float large_step) {
  const int labels = cost.channels();
  const cv::Rect frame({}, cost.size());
  cv::Mat sum(cost.size(), cost.type()), path(cost.size(), cost.type());
  sum.reshape(1).setTo(0);
  // Each path and its reverse; the first four come from pixels earlier in raster order.
  constexpr std::array<std::array<int, 2>, 4> kForwards{{{-1, 0}, {0, -1}, {-1, -1}, {1, -1}}};
  for (const bool reverse : {false, true})
    for (const auto& [dx, dy] : kForwards) {
      const cv::Point to_before = reverse ? cv::Point(-dx, -dy) : cv::Point(dx, dy);
      const int count = static_cast<int>(cost.total());
      for (int i = 0; i < count; ++i) {
        const int raster = reverse ? count - 1 - i : i;
        const cv::Point p(raster % cost.cols, raster / cost.cols), q = p + to_before;
        if (member(p) == 0) continue;
        const bool goes_on = frame.contains(q) && member(q) != 0;
        float* here = path.ptr<float>(p.y, p.x);
        step(cost.ptr<float>(p.y, p.x), goes_on ? path.ptr<float>(q.y, q.x) : nullptr, labels, small_step, large_step, here);
        float* total = sum.ptr<float>(p.y, p.x);
        for (int k = 0; k < labels; ++k) total[k] += here[k];
      }
    }
  return sum;
}

}  // namespace dvi::depth
