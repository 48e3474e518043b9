#include "dvi/synth/texture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dvi::synth {
namespace {

constexpr double kMaxTaps = 8;
// The level is slightly finer than the footprint, since bilinear lookup blurs as well.
constexpr double kLevelBias = -0.4;
constexpr std::size_t kMaxMemoryBytes = 400'000'000;  // 500 m of street, several times the near part of a view

const std::shared_ptr<Scratch>& scratch() {
  static const auto shared = std::make_shared<Scratch>(kMaxMemoryBytes);
  return shared;
}

}  // namespace

Texture::Texture(const cv::Mat3b& picture, const cv::Mat1b& alpha) : pixels_(scratch()), alpha_(alpha) {
  std::vector<cv::Size> sizes{picture.size()};
  while (std::min(sizes.back().width, sizes.back().height) > 1)
    sizes.emplace_back(sizes.back().width / 2, sizes.back().height / 2);
  std::size_t total = 0;
  for (const cv::Size& size : sizes) total += static_cast<std::size_t>(size.area());
  pixels_.resize(total);
  std::size_t begin = 0;
  for (const cv::Size& size : sizes) {
    cv::Mat3b level(size.height, size.width, &pixels_[begin]);
    if (levels_.empty())
      picture.copyTo(level);
    else
      cv::resize(levels_.back(), level, size, 0, 0, cv::INTER_AREA);
    levels_.push_back(level);
    begin += static_cast<std::size_t>(size.area());
  }
}

void Texture::page_out() { scratch()->page_out(); }

bool Texture::solid(double x, double y) const {
  if (alpha_.empty()) return true;
  const int column = std::clamp(static_cast<int>(x), 0, alpha_.cols - 1);
  const int row = std::clamp(static_cast<int>(y), 0, alpha_.rows - 1);
  return alpha_(row, column) > 127;
}

cv::Vec3f Texture::bilinear(int level, float x, float y) const {
  const cv::Mat3b& picture = levels_[level];
  x = std::clamp(x * static_cast<float>(picture.cols) / static_cast<float>(width()) - 0.5F, 0.0F,
                 static_cast<float>(picture.cols - 1));
  y = std::clamp(y * static_cast<float>(picture.rows) / static_cast<float>(height()) - 0.5F, 0.0F,
                 static_cast<float>(picture.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, picture.cols - 1), y1 = std::min(y0 + 1, picture.rows - 1);
  const float u = x - static_cast<float>(x0), v = y - static_cast<float>(y0);
  const cv::Vec3b *top = picture[y0], *bottom = picture[y1];
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    const float a = static_cast<float>(top[x0][c]) * (1 - u) + static_cast<float>(top[x1][c]) * u;
    const float b = static_cast<float>(bottom[x0][c]) * (1 - u) + static_cast<float>(bottom[x1][c]) * u;
    out[c] = a * (1 - v) + b * v;
  }
  return out;
}

cv::Vec3f Texture::trilinear(float level, float x, float y) const {
  level = std::clamp(level, 0.0F, static_cast<float>(levels_.size() - 1));
  const int fine = static_cast<int>(level);
  const float part = level - static_cast<float>(fine);
  cv::Vec3f color = bilinear(fine, x, y);
  if (part > 0) color += (bilinear(fine + 1, x, y) - color) * part;
  return color;
}

cv::Vec3f Texture::sample(double x, double y, const Eigen::Vector2d& step_x, const Eigen::Vector2d& step_y) const {
  const bool first_longer = step_x.squaredNorm() > step_y.squaredNorm();
  const Eigen::Vector2d& along = first_longer ? step_x : step_y;
  const double major = along.norm();
  // The width across the longer step follows from the parallelogram's area, so that sheared footprints do not alias.
  const double area = std::abs(step_x.x() * step_y.y() - step_x.y() * step_y.x());
  const double minor = std::max({area / std::max(major, 1e-9), major / kMaxTaps, 1e-6});
  const int taps = std::clamp(static_cast<int>(std::ceil(major / minor - 0.25)), 1, static_cast<int>(kMaxTaps));
  const auto level = static_cast<float>(std::log2(minor) + kLevelBias);
  cv::Vec3f sum(0, 0, 0);
  for (int i = 0; i < taps; ++i) {
    const double at = (i + 0.5) / taps - 0.5;
    sum += trilinear(level, static_cast<float>(x + at * along.x()), static_cast<float>(y + at * along.y()));
  }
  return sum * (1.0F / static_cast<float>(taps));
}

}  // namespace dvi::synth
