#include "dvi/depth/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/triangle.h"

namespace dvi::depth {
namespace {

constexpr float kRangeNoise = 0.02F;  // meters, of the LiDAR
constexpr float kPoseNoise = 0.01F;   // meters between scans, across a surface: a grazing view sees much of it
constexpr float kUpright = 0.3F;      // sine of what a wall may lean
constexpr float kLanding = 1.1F;      // ratio of depths within which a foot stands on the ground

/// What the triangles show at each pixel.
struct Picture {
  Picture(int height, int width)
      : inverse(height, width, 0.0F), spread(height, width, 0.0F), owner(height, width, -1), gap(height, width, uchar{0}) {}

  cv::Mat1f inverse, spread;  ///< as Triangle::Value
  cv::Mat1i owner;            ///< the surfel whose surface it is; -1: none
  cv::Mat1b gap;              ///< whether nothing was scanned there
};

/// Calls `pixel(x, y, weights of the corners)` for all pixels within a triangle.
template <class Pixel>
void raster(const Triangle& t, cv::Size size, const Pixel& pixel) {
  const Surfel &a = t.corner(0), &b = t.corner(1), &c = t.corner(2);
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
      constexpr float kEdge = -1e-4F;  // a pixel on an edge belongs to either side rather than to none
      if (w[0] >= kEdge && w[1] >= kEdge && w[2] >= kEdge) pixel(x, y, w);
    }
}

Picture paint(const SurfelMesh& mesh, const View& view, bool split_edges) {
  Picture picture(view.camera.height, view.camera.width);
  for (const auto& corners : mesh.triangles) {
    const Triangle triangle(mesh, corners);
    raster(triangle, picture.inverse.size(), [&](int x, int y, const std::array<float, 3>& w) {
      const Triangle::Value value =
          split_edges ? triangle.at(static_cast<float>(x), static_cast<float>(y), w) : triangle.interpolate(w);
      picture.inverse(y, x) = value.inverse;
      picture.spread(y, x) = value.spread;
      picture.owner(y, x) = static_cast<int>(&triangle.corner(value.corner) - mesh.surfels.data());
      picture.gap(y, x) = triangle.gap() ? 255 : 0;
    });
  }
  return picture;
}

/// Where nothing was scanned, what stands upright above goes on downwards if that brings it to the ground: the foot of a pole
/// or a parked car that the traffic hid. A crown, which would hang down like a curtain, meets the ground behind it first.
void stand(Picture& picture, const std::vector<Surfel>& surfels) {
  const int rows = picture.inverse.rows;
  for (int x = 0; x < picture.inverse.cols; ++x)
    for (int y = 1; y < rows; ++y) {
      const int owner = picture.owner(y - 1, x);
      if (picture.gap(y, x) == 0 || owner < 0 || std::abs(surfels[owner].normal.z()) > kUpright) continue;
      const auto plane = [&](int v) { return surfels[owner].inverse_at(static_cast<float>(x), static_cast<float>(v)); };
      int foot = y;
      while (foot < rows && picture.gap(foot, x) != 0 && plane(foot) > picture.inverse(foot, x)) ++foot;
      if (foot == rows || picture.owner(foot, x) < 0 || !surfels[picture.owner(foot, x)].is_ground()) continue;
      const float ratio = plane(foot) / picture.inverse(foot, x);
      if (ratio > kLanding || ratio * kLanding < 1) continue;
      for (; y < foot; ++y) {
        picture.inverse(y, x) = plane(y);
        picture.owner(y, x) = owner;
      }
    }
}

// Per column, the row of the highest return among the columns near it; rows above are sky.
std::vector<int> skyline(const std::vector<Surfel>& surfels, const Camera& camera, double gap_deg) {
  std::vector<int> top(static_cast<std::size_t>(camera.width), camera.height);
  for (const Surfel& p : surfels) {
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

DepthMap depth_map(const map::StaticMap& map, const View& view, const DepthOptions& options) {
  const SurfelMesh mesh = surfel_mesh(map, view, options.splat_m, options.occlusion_tolerance, options.max_slope);
  Picture picture = paint(mesh, view, options.split_edges);
  if (options.split_edges) stand(picture, mesh.surfels);
  if (options.median_px >= 3) cv::medianBlur(picture.inverse.clone(), picture.inverse, options.median_px);

  const std::vector<int> sky = skyline(mesh.surfels, view.camera, options.sky_gap_deg);
  DepthMap depth{cv::Mat1f(picture.inverse.size(), DepthMap::kUnknown), cv::Mat1f(picture.inverse.size(), 0.0F)};
  for (int y = 0; y < depth.z.rows; ++y)
    for (int x = 0; x < depth.z.cols; ++x) {
      const float inverse = picture.inverse(y, x);
      if (y < sky[x]) {
        depth.z(y, x) = DepthMap::kSky;
      } else if (inverse > 0) {
        const int owner = picture.owner(y, x);
        const float across = owner < 0 ? 0 : kPoseNoise / mesh.surfels[owner].cosine;
        depth.z(y, x) = 1 / inverse;
        depth.sigma(y, x) = std::max(picture.spread(y, x), std::hypot(kRangeNoise, across));
      }
    }
  return depth;
}

}  // namespace dvi::depth
