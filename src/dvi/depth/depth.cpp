#include "dvi/depth/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/triangle.h"

namespace dvi::depth {
namespace {

/// Parameters of the depth map that are not options.
struct DepthMapParams {
  float range_sigma_m = 0.02F;       ///< Standard deviation of LiDAR ranges.
  float pose_sigma_m = 0.01F;        ///< Offset of scans to each other along a surface's normal; it grows at grazing angles.
  float max_wall_tilt_sine = 0.3F;   ///< Surfaces whose normals are more level than this are upright.
  float max_ground_ratio = 1.1F;     ///< Ratio of depths within which an extended surface touches the ground.
  float min_corner_weight = -1e-4F;  ///< Negative, so that a pixel on an edge belongs to both triangles rather than to none.
};
constexpr DepthMapParams kDepthMap;

/// The triangles, drawn into the image.
struct TriangleImage {
  TriangleImage(int height, int width)
      : inverse(height, width, 0.0F), spread(height, width, 0.0F), owner(height, width, -1), gap(height, width, uchar{0}) {}

  cv::Mat1f inverse, spread;  ///< The values of Triangle::Value.
  cv::Mat1i owner;            ///< Index of the surfel whose surface is drawn; -1: none.
  cv::Mat1b gap;  ///< 255 where the triangle is wider than the spacing of returns, so that its inside was not scanned.
};

/// Calls `visit(x, y, weights of the corners)` for all pixels within a triangle.
template <class Visit>
void for_each_pixel(const Corners& corners, cv::Size size, const Visit& visit) {
  const Surfel &a = *corners[0], &b = *corners[1], &c = *corners[2];
  const float area = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
  if (std::abs(area) < 1e-6F) return;
  const auto [u0, u1] = std::minmax({a.u, b.u, c.u});
  const auto [v0, v1] = std::minmax({a.v, b.v, c.v});
  const int left = std::max(0, cvCeil(u0 - 0.01F)), right = std::min(size.width - 1, cvFloor(u1 + 0.01F));
  const int top = std::max(0, cvCeil(v0 - 0.01F)), bottom = std::min(size.height - 1, cvFloor(v1 + 0.01F));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float fx = static_cast<float>(x), fy = static_cast<float>(y);
      std::array<float, 3> w{};
      w[1] = ((fx - a.u) * (c.v - a.v) - (c.u - a.u) * (fy - a.v)) / area;
      w[2] = ((b.u - a.u) * (fy - a.v) - (fx - a.u) * (b.v - a.v)) / area;
      w[0] = 1 - w[1] - w[2];
      if (w[0] >= kDepthMap.min_corner_weight && w[1] >= kDepthMap.min_corner_weight && w[2] >= kDepthMap.min_corner_weight)
        visit(x, y, w);
    }
}

TriangleImage draw_triangles(const SurfelMesh& mesh, const View& view, const DepthOptions& options) {
  TriangleImage image(view.camera.height, view.camera.width);
  for (const auto& corners : mesh.triangles) {
    const Corners sorted = sort_corners(mesh, corners);
    std::optional<Triangle> triangle;  // many triangles contain no pixel
    for_each_pixel(sorted, image.inverse.size(), [&](int x, int y, const std::array<float, 3>& w) {
      if (!triangle) triangle.emplace(sorted);
      const Triangle::Value value =
          options.split_edges ? triangle->evaluate(static_cast<float>(x), static_cast<float>(y), w) : triangle->interpolate(w);
      image.inverse(y, x) = value.inverse;
      image.spread(y, x) = value.spread;
      image.owner(y, x) = static_cast<int>(&triangle->corner(value.corner) - mesh.surfels.data());
      image.gap(y, x) = triangle->is_gap() ? 255 : 0;
    });
  }
  return image;
}

/// Extends upright surfaces downward over pixels that were not scanned, if they reach the ground there: the foot of a pole or
/// of a parked car that a removed object occluded. A tree crown is not extended, because the ground behind it is reached first.
void extend_upright_surfaces(TriangleImage& image, const std::vector<Surfel>& surfels) {
  const int rows = image.inverse.rows;
  const cv::Mat1b gap_of_column(image.gap.t());  // columns are read from top to bottom
  for (int x = 0; x < image.inverse.cols; ++x)
    for (int y = 1; y < rows; ++y) {
      if (gap_of_column(x, y) == 0) continue;
      const int owner = image.owner(y - 1, x);
      if (owner < 0 || std::abs(surfels[owner].normal.z()) > kDepthMap.max_wall_tilt_sine) continue;
      const auto plane = [&](int v) { return surfels[owner].inverse_at(static_cast<float>(x), static_cast<float>(v)); };
      int foot = y;
      while (foot < rows && gap_of_column(x, foot) != 0 && plane(foot) > image.inverse(foot, x)) ++foot;
      if (foot == rows || image.owner(foot, x) < 0 || !surfels[image.owner(foot, x)].is_ground()) continue;
      const float ratio = plane(foot) / image.inverse(foot, x);
      if (ratio > kDepthMap.max_ground_ratio || ratio * kDepthMap.max_ground_ratio < 1) continue;
      for (; y < foot; ++y) {
        image.inverse(y, x) = plane(y);
        image.owner(y, x) = owner;
      }
    }
}

/// Finds, per column, the row of the topmost return within `gap_deg` to either side. Rows above it are sky.
std::vector<int> find_skyline(const std::vector<Surfel>& surfels, const Camera& camera, double gap_deg) {
  std::vector<int> top(static_cast<std::size_t>(camera.width), camera.height);
  for (const Surfel& p : surfels) {
    int& row = top[static_cast<std::size_t>(cvRound(p.u))];
    row = std::min(row, cvRound(p.v));
  }
  const int gap_px = cvRound(camera.fx * gap_deg * std::numbers::pi / 180);
  std::vector<int> line(top.size());
  for (int x = 0; x < camera.width; ++x)
    line[x] = *std::min_element(top.begin() + std::max(0, x - gap_px), top.begin() + std::min(camera.width, x + gap_px + 1));
  return line;
}

}  // namespace

DepthMap compute_depth_map(const map::StaticMap& map, const View& view, const DepthOptions& options) {
  const SurfelMesh mesh = make_surfel_mesh(
      map, view,
      {.splat_m = options.splat_m, .occlusion_tolerance = options.occlusion_tolerance, .max_slope = options.max_slope});
  TriangleImage image = draw_triangles(mesh, view, options);
  if (options.split_edges) extend_upright_surfaces(image, mesh.surfels);
  if (options.median_px >= 3) cv::medianBlur(image.inverse.clone(), image.inverse, options.median_px);

  const std::vector<int> sky = find_skyline(mesh.surfels, view.camera, options.sky_gap_deg);
  std::vector<float> sigma;  // one per surfel
  sigma.reserve(mesh.surfels.size());
  for (const Surfel& surfel : mesh.surfels)
    sigma.push_back(std::hypot(kDepthMap.range_sigma_m, kDepthMap.pose_sigma_m / surfel.cosine));
  DepthMap depth{cv::Mat1f(image.inverse.size(), DepthMap::kUnknown), cv::Mat1f(image.inverse.size(), 0.0F)};
  for (int y = 0; y < depth.z.rows; ++y)
    for (int x = 0; x < depth.z.cols; ++x) {
      const float inverse = image.inverse(y, x);
      if (y < sky[x]) {
        depth.z(y, x) = DepthMap::kSky;
      } else if (inverse > 0) {
        const int owner = image.owner(y, x);
        depth.z(y, x) = 1 / inverse;
        depth.sigma(y, x) = std::max(image.spread(y, x), owner < 0 ? kDepthMap.range_sigma_m : sigma[owner]);
      }
    }
  return depth;
}

}  // namespace dvi::depth
