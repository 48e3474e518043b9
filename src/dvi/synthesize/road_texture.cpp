#include "dvi/synthesize/road_texture.h"

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
#include "dvi/synthesize/road_tiles.h"
#include "dvi/synthesize/texture_tile.h"

namespace dvi::synthesize {

struct RoadTexture::Data {
  ground::RoadGround ground;
  RoadTiles road_tiles;

  Data(const ground::RoadGround& road_ground, const Views& views, const Lazy<depth::VisibilityMap>& visibility)
      : ground(road_ground), road_tiles(RoadViews(views, visibility, road_ground.road()), road_ground) {}
};

namespace {

/// Parameters of the intersection of rays with the ground.
struct GroundRayParams {
  double max_depth_m = 60;           ///< Largest depth of the intersection.
  int max_rounds = 4;                ///< Iterations with the height of the ground at the intersection.
  double height_tolerance_m = 1e-3;  ///< Change of the height at which the iteration ends.
  double border_m = 0.1;             ///< Margin at the sides of the tiles.
  int max_samples = 8;               ///< Cells per direction that are averaged for a pixel.
};
constexpr GroundRayParams kGroundRay;

/// Keeps the tiles in use, so that each is requested once.
class TilesInUse {
 public:
  explicit TilesInUse(const Lazy<TextureTile>& from) : from_(from) {}
  const TextureTile& operator[](std::size_t i) {
    std::shared_ptr<const TextureTile>& tile = held_[i];
    if (!tile) tile = from_[i];
    return *tile;
  }

 private:
  const Lazy<TextureTile>& from_;
  std::map<std::size_t, std::shared_ptr<const TextureTile>> held_;
};

/// A ray in world coordinates. `along` has z = 1 in camera axes, so that its parameter is the depth.
struct Ray {
  Eigen::Vector3d from, along;
};

/// An intersection of a ray with the ground.
struct GroundPoint {
  Eigen::Vector2d world;  ///< World x and y.
  double height = 0;      ///< World z.
  Eigen::Vector2d at;     ///< Position along the road, and to the left of its axis.
};

}  // namespace

RoadTexture::RoadTexture(const ground::RoadGround& ground, const Views& views, const Lazy<depth::VisibilityMap>& visibility)
    : data_(std::make_shared<const Data>(ground, views, visibility)) {}

namespace {

/// Computes the depth at which a ray descends to a height.
std::optional<double> intersect_height(const Ray& ray, double height) {
  if (ray.along.z() >= -1e-3) return std::nullopt;
  const double z = (height - ray.from.z()) / ray.along.z();
  return z > 0 && z <= 1.5 * kGroundRay.max_depth_m ? std::optional(z) : std::nullopt;
}

/// Intersects a ray with the ground, starting with a height.
std::optional<GroundPoint> intersect_ground(const Ray& ray, const ground::RoadGround& ground, double height) {
  GroundPoint out;
  double z = 0;
  for (int round = 0; round < kGroundRay.max_rounds; ++round) {
    const std::optional<double> depth = intersect_height(ray, height);
    if (!depth) return std::nullopt;
    z = *depth;
    out.height = height;
    out.world = (ray.from + z * ray.along).head<2>();
    const auto at = ground.road().locate(out.world);
    if (!at || std::abs(at->y()) >= RoadTiles::kHalfWidthM - kGroundRay.border_m) return std::nullopt;
    out.at = *at;
    height = ground.height(at->x(), at->y());
    if (std::abs(height - out.height) < kGroundRay.height_tolerance_m) break;
  }
  return z <= kGroundRay.max_depth_m ? std::optional(out) : std::nullopt;
}

/// Computes the displacement, along the road and to the left, from a point to the intersection of another ray, on a plane.
std::optional<Eigen::Vector2d> displacement_to(const Ray& ray, const GroundPoint& from, const ground::RoadFrame& road) {
  const std::optional<double> z = intersect_height(ray, from.height);
  if (!z) return std::nullopt;
  const Eigen::Vector2d step = (ray.from + *z * ray.along).head<2>() - from.world, ahead = road.direction(from.at.x());
  return Eigen::Vector2d(step.dot(ahead), step.dot(Eigen::Vector2d(-ahead.y(), ahead.x())));
}

/// The parallelogram of the ground that a pixel covers: its center and its sides, along the road and to the left.
struct GroundPixel {
  Eigen::Vector2d at, right, down;
};

/// Computes the mean color of the ground that a pixel covers; `count` is the number of tiles. It is unknown if less than half
/// is known.
RoadColor average_ground(TilesInUse& tiles, std::size_t count, const GroundPixel& pixel) {
  const auto steps = [=](const Eigen::Vector2d& d) {
    return std::clamp(static_cast<int>(std::ceil(d.norm() / RoadTiles::kCellM)), 1, kGroundRay.max_samples);
  };
  const auto& [at, right, down] = pixel;
  const int nx = steps(right), ny = steps(down),
            tile_cells = static_cast<int>(std::lround(RoadTiles::kTileM / RoadTiles::kCellM));
  cv::Vec3f sum;
  int known = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Eigen::Vector2d p = at + ((i + 0.5) / nx - 0.5) * right + ((j + 0.5) / ny - 0.5) * down;
      const int x = static_cast<int>(std::floor(p.x() / RoadTiles::kCellM));
      const int y = static_cast<int>(std::floor((p.y() + RoadTiles::kHalfWidthM) / RoadTiles::kCellM));
      if (x < 0 || y < 0 || x / tile_cells >= static_cast<int>(count)) continue;
      const TextureTile& tile = tiles[x / tile_cells];
      if (y >= tile.known.rows || tile.known(y, x % tile_cells) == 0) continue;
      sum += tile.color(y, x % tile_cells);
      ++known;
    }
  if (2 * known < nx * ny) return {};
  return {sum / known, static_cast<float>(std::max({right.norm(), down.norm(), RoadTiles::kCellM}))};
}

}  // namespace

std::vector<RoadColor> RoadTexture::look_up(const View& view, const Region& region, const cv::Mat1b& classes) const {
  const ground::RoadGround& ground = data_->ground;
  std::vector<RoadColor> out(region.size());
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const auto here = ground.road().locate(world_from_camera.t.head<2>());
  if (!here || !ground.found() || view.sensor != Sensor::lidar) return out;
  TilesInUse tiles(data_->road_tiles.tiles);
  const auto ray = [&](cv::Point p) { return Ray{world_from_camera.t, world_from_camera.R * view.camera.ray({p.x, p.y})}; };
  const double below = ground.height(here->x(), 0);
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point p = region.pixels[i];
    if (classes(p) == static_cast<uchar>(harmonize::SurfaceClass::upright)) continue;
    const auto found = intersect_ground(ray(p), ground, below);
    if (!found) continue;
    const auto right = displacement_to(ray(p + cv::Point(1, 0)), *found, ground.road()),
               down = displacement_to(ray(p + cv::Point(0, 1)), *found, ground.road());
    if (!right || !down) continue;
    out[i] = average_ground(tiles, data_->road_tiles.tiles.size(), {found->at, *right, *down});
    for (int c = 0; c < 3; ++c) out[i].color[c] *= vignetting(view, p) / view.gain[c];
  }
  return out;
}

}  // namespace dvi::synthesize
