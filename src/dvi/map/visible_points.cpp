#include "dvi/map/visible_points.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dvi::map {
namespace {

constexpr float kNearPlane = 0.5F;    // metres
constexpr int kMaxSplat = 12;         // px
constexpr double kCullMargin = 0.15;  // of the image size, for what distortion bends in

// Whether all corners of the tile lie outside one side of the view.
bool outside(const Eigen::AlignedBox3f& bounds, const View& view) {
  const Camera& c = view.camera;
  const double left = (-kCullMargin * c.width - c.cx) / c.fx, right = ((1 + kCullMargin) * c.width - c.cx) / c.fx;
  const double top = (-kCullMargin * c.height - c.cy) / c.fy, bottom = ((1 + kCullMargin) * c.height - c.cy) / c.fy;
  std::array<int, 5> beyond{};
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3f::CornerType>(i);
    const Eigen::Vector3d p = view.camera_from_world * bounds.corner(corner).cast<double>();
    beyond[0] += p.z() < kNearPlane ? 1 : 0;
    beyond[1] += p.x() < left * p.z() ? 1 : 0;
    beyond[2] += p.x() > right * p.z() ? 1 : 0;
    beyond[3] += p.y() < top * p.z() ? 1 : 0;
    beyond[4] += p.y() > bottom * p.z() ? 1 : 0;
  }
  return std::find(beyond.begin(), beyond.end(), 8) != beyond.end();
}

std::vector<VisiblePoint> project(const StaticMap& map, const View& view) {
  const cv::Rect image(0, 0, view.camera.width, view.camera.height);
  std::vector<VisiblePoint> points;
  for (const StaticMap::Tile& tile : map.tiles) {
    if (outside(tile.bounds, view)) continue;
    for (std::size_t i = tile.first; i < tile.last; ++i) {
      const Eigen::Vector3f& world = map.points[i].position;
      const Eigen::Vector3d p = view.camera_from_world * world.cast<double>();
      if (p.z() < kNearPlane || !view.camera.in_front(p)) continue;
      const Eigen::Vector2d pixel = view.camera.project(p);
      const float u = static_cast<float>(pixel.x()), v = static_cast<float>(pixel.y());
      if (!(std::abs(u) < 1e6F && std::abs(v) < 1e6F) || !image.contains({cvRound(u), cvRound(v)})) continue;
      points.push_back({u, v, static_cast<float>(p.z()), world, i});
    }
  }
  return points;
}

cv::Mat1i z_buffer(const std::vector<VisiblePoint>& points, const Camera& camera) {
  cv::Mat1i nearest(camera.height, camera.width, -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    int& at = nearest(cvRound(points[i].v), cvRound(points[i].u));
    if (at < 0 || points[i].z < points[at].z) at = static_cast<int>(i);
  }
  return nearest;
}

// Depth of the nearest disc at each pixel.
cv::Mat1f occluders(const std::vector<VisiblePoint>& points, const cv::Mat1i& nearest, double splat_px_at_1m) {
  cv::Mat1f z(nearest.size(), 1e9F);
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x) {
      if (nearest(y, x) < 0) continue;
      const float depth = points[nearest(y, x)].z;
      const int r = std::min(kMaxSplat, cvRound(splat_px_at_1m / depth));
      for (int dy = -std::min(r, y); dy <= std::min(r, z.rows - 1 - y); ++dy) {
        const int half = static_cast<int>(std::sqrt(static_cast<double>(r * r - dy * dy)));
        float* row = z[y + dy];
        for (int xx = std::max(0, x - half); xx <= std::min(z.cols - 1, x + half); ++xx) row[xx] = std::min(row[xx], depth);
      }
    }
  return z;
}

}  // namespace

std::vector<VisiblePoint> visible_points(const StaticMap& map, const View& view, double splat_m, double tolerance) {
  const std::vector<VisiblePoint> points = project(map, view);
  map.page_out();
  const cv::Mat1i nearest = z_buffer(points, view.camera);
  const cv::Mat1f occluder = occluders(points, nearest, splat_m * view.camera.fx);
  std::vector<VisiblePoint> visible;
  for (int y = 0; y < nearest.rows; ++y)
    for (int x = 0; x < nearest.cols; ++x)
      if (nearest(y, x) >= 0 && points[nearest(y, x)].z <= occluder(y, x) * (1 + tolerance))
        visible.push_back(points[nearest(y, x)]);
  return visible;
}

}  // namespace dvi::map
