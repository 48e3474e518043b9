#include "dvi/depth/packed_depth.h"

#include <algorithm>

namespace dvi::depth {
namespace {

constexpr std::ptrdiff_t kMinRunPixels = 8;  // shorter runs would take more memory than their pixels

const float* find_end_of_run(const float* from, const float* end) {
  return std::find_if(from, end, [value = *from](float z) { return z != value; });
}

}  // namespace

PackedDepth::PackedDepth(const DepthMap& depth, const cv::Mat1b& hole) {
  const cv::Mat1f z = depth.z.isContinuous() ? depth.z : depth.z.clone();
  const float *at = z[0], *const end = at + z.total();
  while (at < end) {
    Run run{*at, 0, 0};
    const float* literal = find_end_of_run(at, end);
    if (literal - at < kMinRunPixels) literal = at;
    run.same = static_cast<std::uint32_t>(literal - at);
    for (at = literal; at < end;) {
      const float* const next = find_end_of_run(at, end);
      if (next - at >= kMinRunPixels) break;
      at = next;
    }
    run.values = static_cast<std::uint32_t>(at - literal);
    z_.insert(z_.end(), literal, at);
    runs_.push_back(run);
  }
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (hole(y, x) != 0) sigma_.push_back(depth.sigma(y, x));
  z_.shrink_to_fit();
}

DepthMap PackedDepth::unpack(const cv::Mat1b& hole) const {
  DepthMap out{cv::Mat1f(hole.size()), cv::Mat1f(hole.size(), 0.0F)};
  float* at = out.z[0];
  const float* literal = z_.data();
  for (const Run& run : runs_) {
    at = std::fill_n(at, run.same, run.value);
    at = std::copy_n(literal, run.values, at);
    literal += run.values;
  }
  const float* sigma = sigma_.data();
  for (int y = 0; y < hole.rows; ++y)
    for (int x = 0; x < hole.cols; ++x)
      if (hole(y, x) != 0) out.sigma(y, x) = *sigma++;
  return out;
}

std::size_t PackedDepth::bytes() const {
  return runs_.capacity() * sizeof(Run) + (z_.capacity() + sigma_.capacity()) * sizeof(float);
}

}  // namespace dvi::depth
