#include "dvi/depth/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/delaunay.h"
#include "dvi/map/visible_points.h"

namespace dvi {
namespace {

constexpr float kRangeNoise = 0.02F;  // metres, of the LiDAR
constexpr float kGroundLike = 0.9F;   // cosine to up: grazing ground is steep in depth without being an edge

/// Paints triangles of visible points into inverse depth and its spread.
class Painter {
 public:
  Painter(const std::vector<VisiblePoint>& points, const View& view, const DepthOptions& options)
      : inverse(view.camera.height, view.camera.width, 0.0F),
        spread(view.camera.height, view.camera.width, 0.0F),
        points_(points),
        focal_(static_cast<float>(view.camera.fx)),
        options_(options) {}

  void paint(const std::array<std::size_t, 3>& corners) {
    std::array<const VisiblePoint*, 3> p{&points_[corners[0]], &points_[corners[1]], &points_[corners[2]]};
    std::sort(p.begin(), p.end(), [](const auto* a, const auto* b) { return a->z < b->z; });
    const float gap_near = slope(*p[0], *p[1]), gap_far = slope(*p[1], *p[2]);
    const bool edge = options_.split_edges && std::max(gap_near, gap_far) > options_.max_slope && !ground_like(p);
    const int near_count = !edge ? 3 : (gap_near > gap_far ? 1 : 2);
    raster(p, [&](int x, int y, const std::array<float, 3>& weight) {
      float value = 0;
      if (!edge)
        for (int k = 0; k < 3; ++k) value += weight[k] / p[k]->z;
      else
        value = 1 / side(p, near_count, static_cast<float>(x), static_cast<float>(y));
      inverse(y, x) = value;
      spread(y, x) = edge ? 0.5F * (p[2]->z - p[0]->z) : 0.1F * (p[2]->z - p[0]->z);
    });
  }

  cv::Mat1f inverse, spread;

 private:
  // Depth over width of the step between two points: how steeply the surface through both leaves the viewer.
  float slope(const VisiblePoint& a, const VisiblePoint& b) const {
    const float px = std::hypot(a.u - b.u, a.v - b.v);
    const float width = std::max(px, 1.0F) * 0.5F * (a.z + b.z) / focal_;
    return std::max(0.0F, b.z - a.z - 3 * kRangeNoise) / width;
  }

  static bool ground_like(const std::array<const VisiblePoint*, 3>& p) {
    const Eigen::Vector3f normal = (p[1]->world - p[0]->world).cross(p[2]->world - p[0]->world);
    return std::abs(normal.z()) > kGroundLike * normal.norm();
  }

  // At an edge the near surface ends within a splat of its last points; what is beyond belongs to the far one.
  float side(const std::array<const VisiblePoint*, 3>& p, int near_count, float x, float y) const {
    int best = -1;
    float best_distance = 0;
    for (int k = 0; k < 3; ++k) {
      const float d = std::hypot(p[k]->u - x, p[k]->v - y);
      const bool is_near = k < near_count;
      const float reach = std::max(0.7F, 0.5F * static_cast<float>(options_.splat_m) * focal_ / p[k]->z);
      if (is_near && d > reach) continue;
      const float rank = is_near ? d - 1e6F : d;
      if (best < 0 || rank < best_distance) {
        best = k;
        best_distance = rank;
      }
    }
    return p[best]->z;
  }

  template <class Pixel>
  void raster(const std::array<const VisiblePoint*, 3>& p, const Pixel& pixel) const {
    const float area = (p[1]->u - p[0]->u) * (p[2]->v - p[0]->v) - (p[2]->u - p[0]->u) * (p[1]->v - p[0]->v);
    if (std::abs(area) < 1e-6F) return;
    const auto [u0, u1] = std::minmax({p[0]->u, p[1]->u, p[2]->u});
    const auto [v0, v1] = std::minmax({p[0]->v, p[1]->v, p[2]->v});
    const int left = std::max(0, cvCeil(u0 - 0.01F)), right = std::min(inverse.cols - 1, cvFloor(u1 + 0.01F));
    const int top = std::max(0, cvCeil(v0 - 0.01F)), bottom = std::min(inverse.rows - 1, cvFloor(v1 + 0.01F));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const float fx = static_cast<float>(x), fy = static_cast<float>(y);
        std::array<float, 3> w{};
        w[1] = ((fx - p[0]->u) * (p[2]->v - p[0]->v) - (p[2]->u - p[0]->u) * (fy - p[0]->v)) / area;
        w[2] = ((p[1]->u - p[0]->u) * (fy - p[0]->v) - (fx - p[0]->u) * (p[1]->v - p[0]->v)) / area;
        w[0] = 1 - w[1] - w[2];
        constexpr float kEdge = -1e-4F;  // a pixel on an edge belongs to either side rather than to none
        if (w[0] >= kEdge && w[1] >= kEdge && w[2] >= kEdge) pixel(x, y, w);
      }
  }

  const std::vector<VisiblePoint>& points_;
  float focal_;
  const DepthOptions& options_;
};

// Per column, the row of the highest return among the columns near it; rows above are sky.
std::vector<int> skyline(const std::vector<VisiblePoint>& points, const Camera& camera, double gap_deg) {
  std::vector<int> top(static_cast<std::size_t>(camera.width), camera.height);
  for (const VisiblePoint& p : points) {
    int& row = top[static_cast<std::size_t>(cvRound(p.u))];
    row = std::min(row, cvRound(p.v));
  }
  const int reach = cvRound(camera.fx * gap_deg * std::numbers::pi / 180);
  std::vector<int> line(top.size());
  for (int x = 0; x < camera.width; ++x)
    line[x] = *std::min_element(top.begin() + std::max(0, x - reach), top.begin() + std::min(camera.width, x + reach + 1));
  return line;
}

}  // namespace

DepthMap depth_map(const StaticMap& map, const View& view, const DepthOptions& options) {
  const std::vector<VisiblePoint> points = visible_points(map, view, options.splat_m, options.see_through);
  Painter painter(points, view, options);
  delaunay(points, [&](const std::array<std::size_t, 3>& corners) { painter.paint(corners); });
  cv::Mat1f inverse = painter.inverse;
  if (options.median_px >= 3) cv::medianBlur(painter.inverse, inverse, options.median_px);

  const std::vector<int> sky = skyline(points, view.camera, options.sky_gap_deg);
  DepthMap depth{cv::Mat1f(inverse.size(), DepthMap::kUnknown), cv::Mat1f(inverse.size(), 0.0F)};
  for (int y = 0; y < inverse.rows; ++y)
    for (int x = 0; x < inverse.cols; ++x) {
      if (y < sky[x]) {
        depth.z(y, x) = DepthMap::kSky;
      } else if (inverse(y, x) > 0) {
        depth.z(y, x) = 1 / inverse(y, x);
        depth.sigma(y, x) = std::max(kRangeNoise, painter.spread(y, x));
      }
    }
  return depth;
}

}  // namespace dvi
