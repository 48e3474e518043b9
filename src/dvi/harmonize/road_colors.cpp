#include "dvi/harmonize/road_colors.h"

#include <algorithm>
#include <cmath>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/sensor.h"
#include "dvi/harmonize/surface_class.h"

namespace dvi::harmonize {
namespace {

/// Parameters of the strips.
struct RoadColorParams {
  double along_m = 2, left_m = 1;    ///< Size of a cell.
  double behind_m = 5;               ///< The first cell is this far behind the camera.
  double reach_m = 8;                ///< Distance along the road at which the influence of a color has fallen to 1/e.
  double across_m = 5;               ///< Distance across the road at which a neighbor is as relevant as the strip.
  float max_relative_sigma = 0.03F;  ///< Relative uncertainty of the depth above which a pixel may show another object.
  double pixels_per_m = 8;           ///< Density at which the ground is read.
  float min_pixels = 3;              ///< Of a cell.
};
constexpr RoadColorParams kRoadColor;

constexpr int kAlong = static_cast<int>((kRoadColor.behind_m + ground::kRoadGround.max_lane_m) / kRoadColor.along_m) + 1;
constexpr int kAcross = static_cast<int>(2 * ground::RoadFrame::kHalfWidthM / kRoadColor.left_m);

}  // namespace

RoadColors::RoadColors(const depth::Target& target, const ground::RoadGround& ground, const cv::Mat3f& color,
                       const cv::Mat1b& known)
    : view_(target.view()), ground_(ground), world_from_camera_(view_.camera_from_world.inverse()) {
  if (view_.sensor != Sensor::lidar) return;
  plane_ = ground::RoadPlane::below(ground, world_from_camera_);
  if (!plane_) return;
  first_m_ = ground.road().locate(world_from_camera_.t.head<2>())->x() - kRoadColor.behind_m;
  cells_.resize(static_cast<std::size_t>(kAlong) * kAcross);
  for (int y = 0; y < color.rows;) {
    // Rows near the horizon are read densely, those near the camera sparsely.
    const Eigen::Vector3d middle = world_from_camera_.R * view_.camera.ray(Eigen::Vector2d(color.cols / 2, y));
    const auto ahead = plane_->meet(middle);
    const int step =
        ahead ? std::clamp(static_cast<int>(view_.camera.fx / (kRoadColor.pixels_per_m * ahead->norm())), 1, 8) : 1;
    for (int x = 0; x < color.cols; x += step) {
      const float z = target.depth.z(y, x);
      if (known(y, x) == 0 || !depth::DepthMap::is_solid(z) || target.depth.sigma(y, x) > kRoadColor.max_relative_sigma * z)
        continue;
      const Eigen::Vector3d ray = world_from_camera_.R * view_.camera.ray(Eigen::Vector2d(x, y));
      const Eigen::Vector3d point = world_from_camera_.t + z * ray;
      const auto height = ground.height(Eigen::Vector2d(point.head<2>()));
      if (!height || point.z() - *height > ground::kRoadGround.max_surface_m) continue;
      if (const auto at = locate(ray, ground::kRoadGround.max_plane_m)) {
        Cell& read = cells_[static_cast<std::size_t>(at->along) * kAcross + at->left];
        read.sum += color(y, x);
        read.count += 1;
      }
    }
    y += step;
  }
  continue_strips();
}

// Replaces each cell by the mean of its strip, weighted by the distance along the road.
void RoadColors::continue_strips() {
  std::vector<Cell> out(cells_.size());
  for (int left = 0; left < kAcross; ++left)
    for (int to = 0; to < kAlong; ++to)
      for (int from = 0; from < kAlong; ++from) {
        const Cell& read = cells_[static_cast<std::size_t>(from) * kAcross + left];
        if (read.count < kRoadColor.min_pixels) continue;
        const auto weight = static_cast<float>(std::exp(-std::abs(from - to) * kRoadColor.along_m / kRoadColor.reach_m));
        Cell& made = out[static_cast<std::size_t>(to) * kAcross + left];
        made.sum += weight / read.count * read.sum;
        made.count += weight;
      }
  cells_ = std::move(out);
}

std::optional<RoadColors::Position> RoadColors::locate(const Eigen::Vector3d& ray, double max_m) const {
  const auto meets = plane_->meet(ray, max_m);
  if (!meets) return std::nullopt;
  const auto at = ground_.road().locate(world_from_camera_.t.head<2>() + *meets);
  if (!at) return std::nullopt;
  const int along = static_cast<int>(std::floor((at->x() - first_m_) / kRoadColor.along_m)),
            left = static_cast<int>(std::floor((at->y() + ground::RoadFrame::kHalfWidthM) / kRoadColor.left_m));
  if (along < 0 || along >= kAlong || left < 0 || left >= kAcross) return std::nullopt;
  return Position{along, left, meets->norm()};
}

std::optional<ColorPull> RoadColors::at(cv::Point p) const {
  if (!plane_) return std::nullopt;
  const auto at = locate(world_from_camera_.R * view_.camera.ray(Eigen::Vector2d(p.x, p.y)), ground::kRoadGround.max_lane_m);
  if (!at) return std::nullopt;
  const Cell& strip = cells_[static_cast<std::size_t>(at->along) * kAcross + at->left];
  if (strip.count == 0) return std::nullopt;
  const double reach_px = kRoadColor.across_m * view_.camera.fx / std::max(at->distance_m, 1.0);
  return ColorPull{strip.sum / strip.count, static_cast<float>(1 / (reach_px * reach_px))};
}

std::vector<ColorPull> pull_along_road(const depth::Target& target, const sample::Candidates& candidates,
                                       const HarmonizeInput& input, const cv::Mat3f& color) {
  const std::vector<cv::Point>& pixels = candidates.hole.pixels;
  std::vector<ColorPull> out(pixels.size());
  if (input.ground == nullptr || input.classes.empty()) return out;
  cv::Mat1b known(color.size(), uchar{255});
  std::vector<std::size_t> unobserved;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const bool is_ground = input.classes(pixels[i]) == static_cast<uchar>(SurfaceClass::ground);
    const bool is_copied = candidates.leading[i].found();
    if (!is_copied || !is_ground) known(pixels[i]) = 0;
    if (!is_copied && is_ground) unobserved.push_back(i);
  }
  if (unobserved.empty()) return out;
  const RoadColors colors(target, *input.ground, color, known);
  for (const std::size_t i : unobserved) out[i] = colors.at(pixels[i]).value_or(ColorPull{});
  return out;
}

}  // namespace dvi::harmonize
