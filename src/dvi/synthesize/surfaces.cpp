#include "dvi/synthesize/surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/sensor.h"
#include "dvi/drive/view.h"
#include "dvi/drive/vignetting.h"
#include "dvi/geometry/se3.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/region.h"
#include "dvi/synthesize/pieces.h"
#include "dvi/synthesize/sheet.h"

namespace dvi::synthesize {

struct Surfaces::Pieces {
  ground::RoadGround ground;
  GroundSheets sheets;

  Pieces(const ground::RoadGround& level, const Views& views, const Lazy<depth::VisibilityMap>& visibility)
      : ground(level), sheets(Painter(views, visibility, level.road()), level) {}
};

namespace {

constexpr double kGroundReach = 60;  // meters

/// Pieces in use, so that they are asked for once.
class Held {
 public:
  explicit Held(const Lazy<Sheet>& from) : from_(from) {}
  const Sheet& operator[](std::size_t i) {
    std::shared_ptr<const Sheet>& kept = held_[i];
    if (!kept) kept = from_[i];
    return *kept;
  }

 private:
  const Lazy<Sheet>& from_;
  std::map<std::size_t, std::shared_ptr<const Sheet>> held_;
};

struct Ray {
  Eigen::Vector3d from, along;  // world; `along` has z = 1 in camera axes
};

struct OnGround {
  Eigen::Vector2d world;  // x, y
  double height = 0;
  Eigen::Vector2d at;  // along, left
};

}  // namespace

Surfaces::Surfaces(const ground::RoadGround& ground, const Views& views, const Lazy<depth::VisibilityMap>& visibility)
    : pieces_(std::make_shared<const Pieces>(ground, views, visibility)) {}

namespace {

/// The depth at which a ray falls to a height.
std::optional<double> depth_at(const Ray& ray, double height) {
  if (ray.along.z() >= -1e-3) return std::nullopt;
  const double z = (height - ray.from.z()) / ray.along.z();
  return z > 0 && z <= 1.5 * kGroundReach ? std::optional(z) : std::nullopt;
}

std::optional<OnGround> on_ground(const Ray& ray, const ground::RoadGround& ground, double height) {
  constexpr double kSame = 1e-3;  // meters
  OnGround out;
  double z = 0;
  for (int round = 0; round < 4; ++round) {
    const std::optional<double> depth = depth_at(ray, height);
    if (!depth) return std::nullopt;
    z = *depth;
    out.height = height;
    out.world = (ray.from + z * ray.along).head<2>();
    const auto at = ground.road().locate(out.world);
    if (!at || std::abs(at->y()) >= GroundSheets::kWide - 0.1) return std::nullopt;
    out.at = *at;
    height = ground.height(at->x(), at->y());
    if (std::abs(height - out.height) < kSame) break;
  }
  return z <= kGroundReach ? std::optional(out) : std::nullopt;
}

/// From there to where another ray meets the ground, along and left, as if the road were level and straight.
std::optional<Eigen::Vector2d> step_to(const Ray& ray, const OnGround& from, const ground::RoadFrame& road) {
  const std::optional<double> z = depth_at(ray, from.height);
  if (!z) return std::nullopt;
  const Eigen::Vector2d step = (ray.from + *z * ray.along).head<2>() - from.world, ahead = road.direction(from.at.x());
  return Eigen::Vector2d(step.dot(ahead), step.dot(Eigen::Vector2d(-ahead.y(), ahead.x())));
}

// The mean over what a pixel covers of the ground.
SurfaceColor mean_of_ground(Held& pieces, std::size_t count, const Eigen::Vector2d& at, const Eigen::Vector2d& right,
                            const Eigen::Vector2d& down) {
  constexpr int kMost = 8;
  const auto steps = [=](const Eigen::Vector2d& d) {
    return std::clamp(static_cast<int>(std::ceil(d.norm() / GroundSheets::kCell)), 1, kMost);
  };
  const int nx = steps(right), ny = steps(down),
            piece_cells = static_cast<int>(std::lround(GroundSheets::kPiece / GroundSheets::kCell));
  cv::Vec3f sum;
  int known = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Eigen::Vector2d p = at + ((i + 0.5) / nx - 0.5) * right + ((j + 0.5) / ny - 0.5) * down;
      const int x = static_cast<int>(std::floor(p.x() / GroundSheets::kCell));
      const int y = static_cast<int>(std::floor((p.y() + GroundSheets::kWide) / GroundSheets::kCell));
      if (x < 0 || y < 0 || x / piece_cells >= static_cast<int>(count)) continue;
      const Sheet& sheet = pieces[x / piece_cells];
      if (y >= sheet.known.rows || sheet.known(y, x % piece_cells) == 0) continue;
      sum += sheet.color(y, x % piece_cells);
      ++known;
    }
  if (2 * known < nx * ny) return {};
  return {sum / known, static_cast<float>(std::max({right.norm(), down.norm(), GroundSheets::kCell}))};
}

}  // namespace

std::vector<SurfaceColor> Surfaces::look_up(const View& view, const Region& region, const cv::Mat1b& classes) const {
  const ground::RoadGround& ground = pieces_->ground;
  std::vector<SurfaceColor> out(region.size());
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const auto here = ground.road().locate(world_from_camera.t.head<2>());
  if (!here || !ground.found() || view.sensor != Sensor::lidar) return out;
  Held pieces(pieces_->sheets.pieces);
  const auto ray = [&](cv::Point p) { return Ray{world_from_camera.t, world_from_camera.R * view.camera.ray({p.x, p.y})}; };
  const double below = ground.height(here->x(), 0);
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point p = region.pixels[i];
    if (classes(p) == static_cast<uchar>(harmonize::SurfaceClass::upright)) continue;
    const auto found = on_ground(ray(p), ground, below);
    if (!found) continue;
    const auto right = step_to(ray(p + cv::Point(1, 0)), *found, ground.road()),
               down = step_to(ray(p + cv::Point(0, 1)), *found, ground.road());
    if (!right || !down) continue;
    out[i] = mean_of_ground(pieces, pieces_->sheets.pieces.size(), found->at, *right, *down);
    for (int c = 0; c < 3; ++c) out[i].color[c] *= vignetting(view, p) / view.gain[c];
  }
  return out;
}

}  // namespace dvi::synthesize
