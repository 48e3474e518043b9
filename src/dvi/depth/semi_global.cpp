#include "dvi/depth/semi_global.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace dvi::depth {
namespace {

/// Computes the path costs of the next pixel from its own costs and the path costs of the pixel before it.
void extend_path(std::span<const float> cost, const float* before, const StepCosts& steps, float* path) {
  const std::size_t labels = cost.size();
  const float least = *std::min_element(before, before + labels);
  for (std::size_t k = 0; k < labels; ++k) {
    float cheapest = std::min(before[k], least + steps.more);
    if (k > 0) cheapest = std::min(cheapest, before[k - 1] + steps.one_label);
    if (k + 1 < labels) cheapest = std::min(cheapest, before[k + 1] + steps.one_label);
    path[k] = cost[k] + cheapest - least;
  }
}

}  // namespace

cv::Mat sum_path_costs(const cv::Mat& cost, const cv::Mat1b& member, const StepCosts& steps) {
  const auto labels = static_cast<std::size_t>(cost.channels());
  const cv::Rect frame({}, cost.size());
  cv::Mat sum(cost.size(), cost.type()), path(cost.size(), cost.type());
  sum.reshape(1).setTo(0);
  // The offsets to the pixel before on four paths, which is earlier in raster order. The other four are their reverse.
  constexpr std::array<std::array<int, 2>, 4> kBefore{{{-1, 0}, {0, -1}, {-1, -1}, {1, -1}}};
  for (const bool reverse : {false, true})
    for (const auto& [dx, dy] : kBefore) {
      const cv::Point to_before = reverse ? cv::Point(-dx, -dy) : cv::Point(dx, dy);
      const int count = static_cast<int>(cost.total());
      for (int i = 0; i < count; ++i) {
        const int raster = reverse ? count - 1 - i : i;
        const cv::Point p(raster % cost.cols, raster / cost.cols), q = p + to_before;
        if (member(p) == 0) continue;
        const std::span<const float> own(cost.ptr<float>(p.y, p.x), labels);
        float* here = path.ptr<float>(p.y, p.x);
        if (frame.contains(q) && member(q) != 0)
          extend_path(own, path.ptr<float>(q.y, q.x), steps, here);
        else
          std::copy(own.begin(), own.end(), here);
        float* total = sum.ptr<float>(p.y, p.x);
        for (std::size_t k = 0; k < labels; ++k) total[k] += here[k];
      }
    }
  return sum;
}

}  // namespace dvi::depth
