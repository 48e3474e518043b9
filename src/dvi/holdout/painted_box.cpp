#include "dvi/holdout/painted_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>

#include "dvi/core/random.h"

namespace dvi::holdout {
namespace {

constexpr double kNoiseCellM = 0.15;  // edge of a cell of noise on a vehicle
constexpr int kNoiseCellPx = 6;       // likewise, on a banner
constexpr double kNoiseLevels = 14;   // largest deviation in gray levels

std::array<double, 3> choose_base_color(std::uint64_t seed) {
  Random random(seed ^ 0xC0104);
  return {random.uniform(50, 200), random.uniform(50, 200), random.uniform(50, 200)};
}

/// A cell of noise: the number of a face, and the position on it in cells.
struct NoiseCell {
  int face, u, v;
};

cv::Vec3b add_noise(const std::array<double, 3>& color, double shade, std::uint64_t seed, const NoiseCell& cell) {
  std::uint64_t key = seed;
  for (const int part : {cell.face, cell.u, cell.v})
    key = Random(key ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(part))).next();
  const double noise = Random(key).uniform(-kNoiseLevels, kNoiseLevels);
  cv::Vec3b out;
  for (int c = 0; c < 3; ++c) out[c] = cv::saturate_cast<uchar>(shade * color[static_cast<std::size_t>(c)] + noise);
  return out;
}

/// Returns the pixels that may show the box; the whole image if corners are behind the camera or the lens has distortion.
cv::Rect bound_pixels(const Box& box, const Camera& camera) {
  const cv::Rect image(0, 0, camera.width, camera.height);
  if (camera.is_distorted()) return image;
  double left = camera.width, right = -1, top = camera.height, bottom = -1;
  for (const Eigen::Vector3d& corner : box.corners()) {
    if (corner.z() < 0.1) return image;
    const Eigen::Vector2d p = camera.project(corner);
    left = std::min(left, p.x()), right = std::max(right, p.x());
    top = std::min(top, p.y()), bottom = std::max(bottom, p.y());
  }
  const auto within = [](double value, int size) { return static_cast<int>(std::floor(std::clamp(value, -1.0, size + 1.0))); };
  const cv::Point first(within(left, camera.width), within(top, camera.height));
  const cv::Point last(within(right, camera.width) + 2, within(bottom, camera.height) + 2);
  return cv::Rect(first, last) & image;
}

}  // namespace

std::optional<BoxHit> find_hit(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d o = box.frame_from_box.R.transpose() * (origin - box.frame_from_box.t);
  const Eigen::Vector3d d = box.frame_from_box.R.transpose() * direction;
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  BoxHit hit;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * box.size[axis];
    if (d[axis] == 0) {
      if (std::abs(o[axis]) > half) return std::nullopt;
      continue;
    }
    const int side = d[axis] > 0 ? -1 : 1;
    const double in = (side * half - o[axis]) / d[axis], out = (-side * half - o[axis]) / d[axis];
    if (in > enter) enter = in, hit.axis = axis, hit.side = side;
    leave = std::min(leave, out);
  }
  if (hit.side == 0 || enter > leave) return std::nullopt;
  hit.distance = enter;
  hit.point = o + enter * d;
  return hit;
}

Painting paint_box(const Box& camera_box, const Camera& camera, std::uint64_t seed) {
  constexpr std::array kShades = {0.55, 0.8, 1.15};  // front and rear, sides, top and bottom
  const std::array<double, 3> color = choose_base_color(seed);
  Painting painting{cv::Mat3b(camera.height, camera.width, cv::Vec3b()), cv::Mat1b(camera.height, camera.width, uchar{0})};
  const cv::Rect area = bound_pixels(camera_box, camera);
  for (int y = area.y; y < area.y + area.height; ++y)
    for (int x = area.x; x < area.x + area.width; ++x) {
      const auto hit = find_hit(camera_box, Eigen::Vector3d::Zero(), camera.ray({x, y}));
      if (!hit) continue;
      const double u = hit->point[(hit->axis + 1) % 3], v = hit->point[(hit->axis + 2) % 3];
      const NoiseCell cell{2 * hit->axis + (hit->side > 0 ? 1 : 0), static_cast<int>(std::floor(u / kNoiseCellM)),
                           static_cast<int>(std::floor(v / kNoiseCellM))};
      painting.colors(y, x) = add_noise(color, kShades[static_cast<std::size_t>(hit->axis)], seed, cell);
      painting.pixels(y, x) = 255;
    }
  return painting;
}

Painting paint_banner(cv::Size image, std::uint64_t seed) {
  Random random(seed ^ 0xBA22E5);
  const std::array<double, 3> color = choose_base_color(seed);
  const int left = static_cast<int>(image.width * random.uniform(0.25, 0.5));
  const int top = static_cast<int>(image.height * random.uniform(0.55, 0.7));
  const cv::Rect area(left, top, image.width / 4, image.height / 6);
  Painting painting{cv::Mat3b(image, cv::Vec3b()), cv::Mat1b(image, uchar{0})};
  for (int y = area.y; y < area.y + area.height; ++y)
    for (int x = area.x; x < area.x + area.width; ++x)
      painting.colors(y, x) = add_noise(color, 1, seed, {0, (x - area.x) / kNoiseCellPx, (y - area.y) / kNoiseCellPx});
  painting.pixels(area) = 255;
  return painting;
}

cv::Vec3b get_outline_color(std::uint64_t seed) {
  cv::Vec3b color;
  const std::array<double, 3> base = choose_base_color(seed);
  for (int c = 0; c < 3; ++c) color[c] = static_cast<uchar>(0.3 * base[static_cast<std::size_t>(c)]);
  return color;
}

}  // namespace dvi::holdout
