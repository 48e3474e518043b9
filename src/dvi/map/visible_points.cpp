#include "dvi/map/visible_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dvi::map {
namespace {

constexpr float kNearPlaneM = 0.5F;
constexpr int kMaxSplatPx = 12;
constexpr double kCullMargin = 0.15;  // share of the image size, for points that distortion moves into the image
constexpr double kMaxPixelM = 0.5;    // size of a pixel on a surface at the far plane

double compute_far_plane_m(const Camera& camera) { return kMaxPixelM * camera.fx; }

/// Returns whether the tile is farther away than the far corners of the view, as are most tiles of a long drive.
bool is_beyond(const Eigen::AlignedBox3f& bounds, const Eigen::Vector3f& eye, const Camera& c) {
  const double x = (0.5 + kCullMargin) * c.width + std::abs(c.cx - 0.5 * c.width);
  const double y = (0.5 + kCullMargin) * c.height + std::abs(c.cy - 0.5 * c.height);
  const double farthest = compute_far_plane_m(c) * std::hypot(1, x / c.fx, y / c.fy);
  return bounds.squaredExteriorDistance(eye) > farthest * farthest;
}

/// Returns whether all corners of the tile are outside the same side of the view. A wide camera has no such sides.
bool is_outside(const Eigen::AlignedBox3f& bounds, const View& view) {
  const Camera& c = view.camera;
  if (c.is_wide()) return false;
  const double left = (-kCullMargin * c.width - c.cx) / c.fx, right = ((1 + kCullMargin) * c.width - c.cx) / c.fx;
  const double top = (-kCullMargin * c.height - c.cy) / c.fy, bottom = ((1 + kCullMargin) * c.height - c.cy) / c.fy;
  const double far = compute_far_plane_m(c);
  std::array<int, 6> beyond{};
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3f::CornerType>(i);
    const Eigen::Vector3d p = view.camera_from_world * bounds.corner(corner).cast<double>();
    beyond[0] += p.z() < kNearPlaneM ? 1 : 0;
    beyond[1] += p.x() < left * p.z() ? 1 : 0;
    beyond[2] += p.x() > right * p.z() ? 1 : 0;
    beyond[3] += p.y() < top * p.z() ? 1 : 0;
    beyond[4] += p.y() > bottom * p.z() ? 1 : 0;
    beyond[5] += p.z() > far ? 1 : 0;
  }
  return std::find(beyond.begin(), beyond.end(), 8) != beyond.end();
}

/// The nearest point of a pixel.
struct NearestPoint {
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  float z = 1e9F, u = 0, v = 0;
  std::uint32_t index = kNone;  ///< In StaticMap::points.
};

/// The nearest points of all pixels, in raster order.
struct ZBuffer {
  explicit ZBuffer(const Camera& camera)
      : width(camera.width),
        height(camera.height),
        nearest(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)) {}

  void add(const NearestPoint& point) {
    const int x = cvRound(point.u), y = cvRound(point.v);
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    NearestPoint& pixel = nearest[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    if (point.z < pixel.z) pixel = point;
  }
  const NearestPoint* row(int y) const {
    return nearest.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }

  int width, height;
  std::vector<NearestPoint> nearest;
};

ZBuffer project(const StaticMap& map, const View& view) {
  ZBuffer buffer(view.camera);
  const double far = compute_far_plane_m(view.camera);
  const Eigen::Vector3f eye = view.camera_from_world.inverse().t.cast<float>();
  const bool is_distorted = view.camera.is_distorted();  // otherwise, all points beyond the near plane are in front
  for (const StaticMap::Tile& tile : map.tiles) {
    if (is_beyond(tile.bounds, eye, view.camera) || is_outside(tile.bounds, view)) continue;
    for (std::size_t i = tile.first; i < tile.last; ++i) {
      if (!map.points[i].is_present_in(static_cast<std::size_t>(view.drive))) continue;
      const Eigen::Vector3d p = view.camera_from_world * map.points[i].position.cast<double>();
      const double depth_m = view.camera.depth(p);
      if (depth_m < kNearPlaneM || depth_m > far || (is_distorted && !view.camera.in_front(p))) continue;
      const Eigen::Vector2d pixel = view.camera.project(p);
      const float u = static_cast<float>(pixel.x()), v = static_cast<float>(pixel.y());
      if (std::abs(u) < 1e6F && std::abs(v) < 1e6F)
        buffer.add({static_cast<float>(depth_m), u, v, static_cast<std::uint32_t>(i)});
    }
  }
  return buffer;
}

// Half the width of the rows of a disc, by its radius and their distance from its center.
using Disc = std::array<int, kMaxSplatPx + 1>;
std::array<Disc, kMaxSplatPx + 1> make_discs() {
  std::array<Disc, kMaxSplatPx + 1> out{};
  for (int r = 0; r <= kMaxSplatPx; ++r)
    for (int dy = 0; dy <= r; ++dy) out[r][dy] = static_cast<int>(std::sqrt(static_cast<double>(r * r - dy * dy)));
  return out;
}

/// Renders the depth of the nearest disc at each pixel.
cv::Mat1f render_occluders(const ZBuffer& buffer, double splat_px_at_1m) {
  const std::array<Disc, kMaxSplatPx + 1> half_width = make_discs();
  cv::Mat1f z(buffer.height, buffer.width);
  std::transform(buffer.nearest.begin(), buffer.nearest.end(), z.begin(), [](const NearestPoint& point) { return point.z; });
  for (int y = 0; y < z.rows; ++y) {
    const NearestPoint* points = buffer.row(y);
    for (int x = 0; x < z.cols; ++x) {
      if (points[x].index == NearestPoint::kNone) continue;
      const float depth = points[x].z;
      const int r = std::min(kMaxSplatPx, cvRound(splat_px_at_1m / depth));
      if (r == 0) continue;
      for (int dy = -std::min(r, y); dy <= std::min(r, z.rows - 1 - y); ++dy) {
        const int half = half_width[r][std::abs(dy)], last = std::min(z.cols - 1, x + half);
        float* row = z[y + dy];
        for (int xx = std::max(0, x - half); xx <= last; ++xx) row[xx] = std::min(row[xx], depth);
      }
    }
  }
  return z;
}

}  // namespace

std::vector<VisiblePoint> find_visible_points(const StaticMap& map, const View& view, double splat_m, double tolerance) {
  const ZBuffer buffer = project(map, view);
  const cv::Mat1f occluder = render_occluders(buffer, splat_m * view.camera.fx);
  const auto count = std::count_if(buffer.nearest.begin(), buffer.nearest.end(),
                                   [](const NearestPoint& point) { return point.index != NearestPoint::kNone; });
  std::vector<VisiblePoint> visible;
  visible.reserve(static_cast<std::size_t>(count));
  for (int y = 0; y < occluder.rows; ++y) {
    const NearestPoint* points = buffer.row(y);
    for (int x = 0; x < occluder.cols; ++x) {
      const auto& [z, u, v, index] = points[x];
      if (index != NearestPoint::kNone && z <= occluder(y, x) * (1 + tolerance))
        visible.push_back({u, v, z, map.points[index].position, index});
    }
  }
  map.page_out();
  return visible;
}

}  // namespace dvi::map
