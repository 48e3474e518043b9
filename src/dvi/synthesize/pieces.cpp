#include "dvi/synthesize/pieces.h"

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
#include "dvi/synthesize/sheet.h"

namespace dvi::synthesize {
namespace {

int cells(double meters, double cell) { return static_cast<int>(std::lround(meters / cell)); }

// A view, ready to be looked up.
struct Lookup {
  const View* view;
  std::shared_ptr<const cv::Mat3b> image;
  std::shared_ptr<const depth::VisibilityMap> visible;

  /// What it shows of a point, from `least_z` meters on.
  std::optional<cv::Vec3f> color(const Eigen::Vector3d& world, double least_z) const {
    constexpr double kTolerance = 0.1;  // of depth: what the ground's height is off by
    constexpr float kClear = 3;         // px to masks and edges
    const Eigen::Vector3d x = view->camera_from_world * world;
    if (x.z() < least_z || !view->camera.in_front(x)) return std::nullopt;
    const Eigen::Vector2d at = view->camera.project(x);
    if (!view->camera.contains(at)) return std::nullopt;
    const cv::Point2f p(static_cast<float>(at.x()), static_cast<float>(at.y()));
    if (visible->is_masked(p) || visible->clearance_px(p) < kClear) return std::nullopt;
    if (visible->occludes(p, x.z(), kTolerance)) return std::nullopt;
    return bilinear(*image, p).mul(view->gain) / vignetting(*view, p);
  }
};

std::vector<Lookup> shown(const Painter& painter, const std::vector<std::size_t>& which) {
  std::vector<Lookup> out;
  for (const std::size_t i : which) out.push_back({&(*painter.views)[i], painter.views->images[i], painter.visibility[i]});
  return out;
}

}  // namespace

Painter::Painter(const Views& of, const Lazy<depth::VisibilityMap>& seen, const ground::RoadFrame& road)
    : views(&of), visibility(seen) {
  const auto [first, last] = of.of_sequence(0);
  for (std::size_t i = first; i < last; ++i) {
    const auto at = road.locate(of[i].camera_from_world.inverse().t.head<2>());
    along.push_back(at ? at->x() : -1e9);
  }
}

std::vector<std::size_t> Painter::between(double first, double last, double nearest_to) const {
  constexpr double kApart = 0.7;     // meters: more views of a place show no more of it
  constexpr std::size_t kMost = 24;  // that are held at a time
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < along.size(); ++i)
    if (along[i] >= first && along[i] <= last && (out.empty() || std::abs(along[i] - along[out.back()]) >= kApart))
      out.push_back(i);
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(along[a] - nearest_to) < std::abs(along[b] - nearest_to);
  });
  if (out.size() > kMost) out.resize(kMost);
  return out;
}

namespace {

// Of the ground from `first` meters, as long as `columns`.
Sheet paint_ground(const Painter& painter, const ground::RoadGround& ground, double first, int columns) {
  constexpr double kNearest = 4, kFarthest = 60, kBest = 8;  // meters from the camera
  const double cell = GroundSheets::kCell, middle = first + columns * cell / 2;
  Sheet sheet({columns, cells(2 * GroundSheets::kWide, cell)});
  const std::vector<Lookup> views = shown(painter, painter.between(middle - kFarthest, middle - kNearest, middle - kBest));
  for (int x = 0; x < columns; ++x) {
    const double along = first + (x + 0.5) * cell;
    for (int y = 0; y < sheet.known.rows; ++y) {
      const double left = (y + 0.5) * cell - GroundSheets::kWide;
      const Eigen::Vector2d place = ground.road().place(along, left);
      const Eigen::Vector3d world(place.x(), place.y(), ground.height(along, left));
      for (const Lookup& view : views)
        if (const auto color = view.color(world, kNearest - 1)) {
          sheet.color(y, x) = *color;
          sheet.known(y, x) = 255;
          break;
        }
    }
  }
  return sheet;
}

cv::Point ground_cells(double along, double left) {
  const auto whole = [](double meters) { return 4 * cells(meters, 4 * GroundSheets::kCell); };
  return {whole(along), whole(left)};
}

std::vector<std::vector<cv::Point>> ground_offsets() {
  // Not multiples of each other, so that what repeats does not line up.
  const std::vector<double> alongs{2.6, 3.8, 5.4, 7.4, 9.8, 12.2}, lefts{1.2, 2.2, 3.8, 5.6, 8};
  std::vector<cv::Point> straight, aside;
  for (const double along : alongs)
    for (const int sign : {-1, 1}) straight.push_back(ground_cells(sign * along, 0));
  for (const double left : lefts)
    for (const double along : {0.6, 4.6})
      for (const int sign : {-1, 1})
        for (const int side : {-1, 1}) aside.push_back(ground_cells(sign * along, side * left));
  return {straight, straight, aside, aside};
}

// Joined from pieces [from, to].
Sheet joined(const Lazy<Sheet>& pieces, std::size_t from, std::size_t to) {
  std::vector<cv::Mat> colors, known;
  std::vector<std::shared_ptr<const Sheet>> held;
  for (std::size_t i = from; i <= to; ++i) {
    held.push_back(pieces[i]);
    colors.push_back(held.back()->color);
    known.push_back(held.back()->known);
  }
  Sheet out;
  cv::hconcat(colors, out.color);
  cv::hconcat(known, out.known);
  return out;
}

}  // namespace

GroundSheets::GroundSheets(const Painter& painter, const ground::RoadGround& ground) {
  constexpr double kReach = 2;  // meters of surroundings that offsets are judged by
  const auto count = static_cast<std::size_t>(ground.road().length() / kPiece);
  const Lazy<Sheet> painted(count, [=](std::size_t i) {
    return paint_ground(painter, ground, static_cast<double>(i) * kPiece, cells(kPiece, kCell));
  });
  pieces = {count, [=](std::size_t i) {
              const std::size_t from = i - std::min<std::size_t>(i, 1), to = std::min(i + 1, count - 1);
              Sheet sheet = joined(painted, from, to);
              complete(sheet, ground_offsets(), kReach / kCell);
              const int width = cells(kPiece, kCell);
              const cv::Rect own(static_cast<int>(i - from) * width, 0, width, sheet.known.rows);
              Sheet out;
              out.color = sheet.color(own).clone();
              out.known = sheet.known(own).clone();
              return out;
            }};
}

}  // namespace dvi::synthesize
