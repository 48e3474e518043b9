#include "dvi/synthesize/road_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/core/lazy.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"
#include "dvi/drive/vignetting.h"
#include "dvi/ground/road_frame.h"
#include "dvi/ground/road_ground.h"
#include "dvi/image/interpolate.h"
#include "dvi/synthesize/texture_tile.h"

namespace dvi::synthesize {
namespace {

/// Parameters of the tiles.
struct RoadTileParams {
  double depth_tolerance = 0.1;   ///< Relative tolerance of occlusion tests, because the ground's height has errors.
  float min_clearance_px = 3;     ///< Distance to masks and depth edges.
  double view_step_m = 0.7;       ///< Distance of views along the road; nearer ones show the same.
  std::size_t max_views = 24;     ///< Views of a tile that are in memory together.
  double min_distance_m = 4;      ///< Smallest distance from the camera to the middle of the tile.
  double max_distance_m = 60;     ///< Largest distance from the camera to the middle of the tile.
  double best_distance_m = 8;     ///< Distance from the camera to the middle of the tile at which views are preferred.
  double comparison_sigma_m = 2;  ///< Size of the surroundings by which offsets are compared.
  int offset_step_cells = 4;      ///< Offsets are multiples of this, as complete() demands.
};
constexpr RoadTileParams kRoadTile;

int to_cells(double meters, double cell) { return static_cast<int>(std::lround(meters / cell)); }

/// A view whose colors are read.
struct ViewReader {
  const View* view;
  std::shared_ptr<const cv::Mat3b> image;
  std::shared_ptr<const depth::VisibilityMap> visible;

  /// Reads the color of a point in common illumination; nothing if it is not visible, or its depth is below `min_depth_m`.
  std::optional<cv::Vec3f> read(const Eigen::Vector3d& world, double min_depth_m) const {
    const Eigen::Vector3d x = view->camera_from_world * world;
    if (x.z() < min_depth_m || !view->camera.in_front(x)) return std::nullopt;
    const Eigen::Vector2d at = view->camera.project(x);
    if (!view->camera.contains(at)) return std::nullopt;
    const cv::Point2f p(static_cast<float>(at.x()), static_cast<float>(at.y()));
    if (visible->is_masked(p) || visible->clearance_px(p) < kRoadTile.min_clearance_px) return std::nullopt;
    if (visible->occludes(p, x.z(), kRoadTile.depth_tolerance)) return std::nullopt;
    return bilinear(*image, p).mul(view->gain) / vignetting(*view, p);
  }
};

std::vector<ViewReader> open_views(const RoadViews& views, const std::vector<std::size_t>& selected) {
  std::vector<ViewReader> out;
  for (const std::size_t i : selected) out.push_back({&(*views.views)[i], views.views->images[i], views.visibility[i]});
  return out;
}

}  // namespace

RoadViews::RoadViews(const Views& all, const Lazy<depth::VisibilityMap>& visibility_maps, const ground::RoadFrame& road)
    : views(&all), visibility(visibility_maps) {
  const auto [first, last] = all.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const auto at = road.locate(all[i].camera_from_world.inverse().t.head<2>());
    along_m.push_back(at ? at->x() : -1e9);
  }
}

std::vector<std::size_t> RoadViews::list_between(double first, double last, double preferred) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < along_m.size(); ++i)
    if (along_m[i] >= first && along_m[i] <= last &&
        (out.empty() || std::abs(along_m[i] - along_m[out.back()]) >= kRoadTile.view_step_m))
      out.push_back(i);
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(along_m[a] - preferred) < std::abs(along_m[b] - preferred);
  });
  if (out.size() > kRoadTile.max_views) out.resize(kRoadTile.max_views);
  return out;
}

namespace {

/// Reads the colors of the ground of a tile that begins at `first` meters along the road, from the first view that shows each
/// cell.
TextureTile read_tile(const RoadViews& road_views, const ground::RoadGround& ground, double first, int columns) {
  const double cell = RoadTiles::kCellM, middle = first + columns * cell / 2;
  TextureTile tile({columns, to_cells(2 * RoadTiles::kHalfWidthM, cell)});
  const std::vector<ViewReader> views =
      open_views(road_views, road_views.list_between(middle - kRoadTile.max_distance_m, middle - kRoadTile.min_distance_m,
                                                     middle - kRoadTile.best_distance_m));
  for (int x = 0; x < columns; ++x) {
    const double along = first + (x + 0.5) * cell;
    for (int y = 0; y < tile.known.rows; ++y) {
      const double left = (y + 0.5) * cell - RoadTiles::kHalfWidthM;
      const Eigen::Vector2d place = ground.road().to_world(along, left);
      const Eigen::Vector3d world(place.x(), place.y(), ground.height(along, left));
      for (const ViewReader& view : views)
        if (const auto color = view.read(world, kRoadTile.min_distance_m - 1)) {
          tile.color(y, x) = *color;
          tile.known(y, x) = 255;
          break;
        }
    }
  }
  return tile;
}

cv::Point to_offset(double along, double left) {
  constexpr int kStep = kRoadTile.offset_step_cells;
  const auto round_to_step = [](double meters) { return kStep * to_cells(meters, kStep * RoadTiles::kCellM); };
  return {round_to_step(along), round_to_step(left)};
}

/// Lists the rounds of offsets of complete(): along the road, then also to the sides.
std::vector<std::vector<cv::Point>> list_offsets() {
  // They are not multiples of each other, so that repetitions are not aligned.
  const std::vector<double> alongs{2.6, 3.8, 5.4, 7.4, 9.8, 12.2}, lefts{1.2, 2.2, 3.8, 5.6, 8};
  std::vector<cv::Point> along_road, to_sides;
  for (const double along : alongs)
    for (const int sign : {-1, 1}) along_road.push_back(to_offset(sign * along, 0));
  for (const double left : lefts)
    for (const double along : {0.6, 4.6})
      for (const int sign : {-1, 1})
        for (const int side : {-1, 1}) to_sides.push_back(to_offset(sign * along, side * left));
  return {along_road, along_road, to_sides, to_sides};
}

/// Concatenates the tiles from `from` to `to`, inclusive.
TextureTile concatenate(const Lazy<TextureTile>& tiles, std::size_t from, std::size_t to) {
  std::vector<cv::Mat> colors, known;
  std::vector<std::shared_ptr<const TextureTile>> held;
  for (std::size_t i = from; i <= to; ++i) {
    held.push_back(tiles[i]);
    colors.push_back(held.back()->color);
    known.push_back(held.back()->known);
  }
  TextureTile out;
  cv::hconcat(colors, out.color);
  cv::hconcat(known, out.known);
  return out;
}

}  // namespace

RoadTiles::RoadTiles(const RoadViews& views, const ground::RoadGround& ground) {
  const auto count = static_cast<std::size_t>(ground.road().length() / kTileM);
  const Lazy<TextureTile> incomplete(count, [=](std::size_t i) {
    return read_tile(views, ground, static_cast<double>(i) * kTileM, to_cells(kTileM, kCellM));
  });
  tiles = {count, [=](std::size_t i) {
             const std::size_t from = i - std::min<std::size_t>(i, 1), to = std::min(i + 1, count - 1);
             TextureTile tile = concatenate(incomplete, from, to);
             complete(tile, list_offsets(), kRoadTile.comparison_sigma_m / kCellM);
             const int width = to_cells(kTileM, kCellM);
             const cv::Rect own(static_cast<int>(i - from) * width, 0, width, tile.known.rows);
             TextureTile out;
             out.color = tile.color(own).clone();
             out.known = tile.known(own).clone();
             return out;
           }};
}

}  // namespace dvi::synthesize
