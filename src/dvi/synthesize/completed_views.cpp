#include "dvi/synthesize/completed_views.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/vignetting.h"
#include "dvi/geometry/se3.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {
namespace {

/// Parameters of completed views.
struct CompletedViewParams {
  double step_m = 5;            ///< Path between completed views.
  double step_rad = 0.2;        ///< Rotation between completed views.
  double max_distance_m = 150;  ///< Distance from which a completed view is not shown.
  double far_m = 300;           ///< Depth of surfaces without depth, such as the sky.
  double max_ground_m = 200;    ///< Largest depth of the ground.
  int median_px = 5;            ///< Side of the square whose median depth an upright surface has.
  int ground_rounds = 4;        ///< Iterations of the intersection of a ray with the ground.
  int max_footprint_px = 12;    ///< Largest area of a completed view that is averaged for a pixel.
};
constexpr CompletedViewParams kCompletedView;

/// Computes the depth at which the ray of a pixel intersects the ground; nothing above the horizon or far away.
std::optional<double> intersect_ground(const SE3& world_from_camera, const Eigen::Vector3d& ray,
                                       const ground::RoadGround& ground) {
  const Eigen::Vector3d direction = world_from_camera.R * ray;
  const auto here = ground.road().locate(world_from_camera.t.head<2>());
  if (direction.z() >= -1e-4 || !here) return std::nullopt;
  double height = ground.height(here->x(), 0), z = 0;
  for (int round = 0; round < kCompletedView.ground_rounds; ++round) {
    z = (height - world_from_camera.t.z()) / direction.z();
    if (!(z > 0 && z < kCompletedView.max_ground_m)) return std::nullopt;
    const Eigen::Vector2d at = (world_from_camera.t + z * direction).head<2>();
    const std::optional<double> found = ground.height(at);
    if (!found) break;
    height = *found;
  }
  return z;
}

/// A completed view as images, in the bounding box of its pixels.
struct CompletedImage {
  CompletedImage(const CompletedView& completed, const View& view) {
    if (completed.pixels.empty()) return;
    const auto to_point = [&](std::int32_t i) { return cv::Point(i % view.camera.width, i / view.camera.width); };
    std::vector<cv::Point> points;
    points.reserve(completed.size());
    for (const std::int32_t i : completed.pixels) points.push_back(to_point(i));
    box = cv::boundingRect(points);
    color = cv::Mat3b(box.size(), cv::Vec3b());
    depth_m = cv::Mat1f(box.size(), 0.0F);
    for (std::size_t i = 0; i < completed.size(); ++i) {
      color(points[i] - box.tl()) = completed.colors[i];
      depth_m(points[i] - box.tl()) = completed.depths_m[i];
    }
  }

  /// Returns the mean color over a square around a position in the image; nothing if no pixel of the completed view is there.
  std::optional<cv::Vec3f> read(const Eigen::Vector2d& at, int side) const {
    const double x = at.x() - box.x, y = at.y() - box.y;
    cv::Vec3f sum;
    float weights = 0;
    const double half = 0.5 * side;
    const int x0 = std::max(static_cast<int>(std::ceil(x - half - 0.5)), 0),
              y0 = std::max(static_cast<int>(std::ceil(y - half - 0.5)), 0);
    for (int j = y0; j < box.height && j < y + half + 0.5; ++j)
      for (int i = x0; i < box.width && i < x + half + 0.5; ++i) {
        if (depth_m(j, i) == 0) continue;
        // The overlap of the pixel with the square.
        const double u = std::min({1.0, half + 0.5 - std::abs(i - x)}), v = std::min({1.0, half + 0.5 - std::abs(j - y)});
        if (u <= 0 || v <= 0) continue;
        sum += static_cast<float>(u * v) * cv::Vec3f(color(j, i));
        weights += static_cast<float>(u * v);
      }
    if (weights < 0.25F) return std::nullopt;
    return sum / weights;
  }

  cv::Rect box;
  cv::Mat3b color;
  cv::Mat1f depth_m;
};

/// Projects the pixels of a completed view into a view. Returns the smallest depth in each pixel, 0 where there is none.
cv::Mat1f project_depths(const CompletedImage& completed, const View& from, const View& view, const cv::Mat1b& wanted) {
  cv::Mat1f out(wanted.size(), 0.0F);
  const SE3 view_from_completed = view.camera_from_world * from.camera_from_world.inverse();
  for (int y = 0; y < completed.box.height; ++y)
    for (int x = 0; x < completed.box.width; ++x) {
      const float z = completed.depth_m(y, x);
      if (z == 0) continue;
      const Eigen::Vector3d point = view_from_completed * (z * from.camera.ray({x + completed.box.x, y + completed.box.y}));
      const double depth_m = view.camera.depth(point);
      if (depth_m < 0.5 || !view.camera.in_front(point)) continue;
      const Eigen::Vector2d at = view.camera.project(point);
      const double half = 0.5 * std::clamp(1.1 * z / depth_m * view.camera.fx / from.camera.fx, 1.0, 8.0);
      const int x0 = std::max(static_cast<int>(std::ceil(at.x() - half)), 0),
                y0 = std::max(static_cast<int>(std::ceil(at.y() - half)), 0);
      for (int j = y0; j < out.rows && j <= at.y() + half; ++j)
        for (int i = x0; i < out.cols && i <= at.x() + half; ++i)
          if (wanted(j, i) != 0 && (out(j, i) == 0 || depth_m < out(j, i))) out(j, i) = static_cast<float>(depth_m);
    }
  return out;
}

std::vector<std::size_t> select_of_camera(const Views& views, int sequence) {
  const auto [first, last] = views.of_sequence(sequence);
  std::vector<std::size_t> order;
  double forward_m = 0;
  for (std::size_t i = first; i < last; ++i) {
    order.push_back(i);
    if (i == first) continue;
    const Eigen::Vector3d moved = views[i - 1].camera_from_world * views[i].camera_from_world.inverse().t;
    forward_m += moved.z();
  }
  if (forward_m >= 0) std::reverse(order.begin(), order.end());
  std::vector<std::size_t> out;
  for (const std::size_t i : order) {
    if (!out.empty() && i != order.back()) {
      const SE3 motion = views[i].camera_from_world * views[out.back()].camera_from_world.inverse();
      if (motion.t.norm() < kCompletedView.step_m && so3_log(motion.R).norm() < kCompletedView.step_rad) continue;
    }
    out.push_back(i);
  }
  return out;
}

}  // namespace

std::vector<std::size_t> select_views_to_complete(const Views& views) {
  std::vector<std::size_t> out;
  for (int sequence = 0; sequence < views.cleaned_sequences; ++sequence)
    for (const std::size_t view : select_of_camera(views, sequence)) out.push_back(view);
  return out;
}

CompletedView make_completed_view(const SynthesizedFrame& made, const Views& views, std::size_t index,
                                  const ground::RoadGround& ground) {
  const auto& [frame, completed, guide] = made;
  const View& view = views[index];
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const int width = frame.kind.cols;
  CompletedView out{index, {}, {}, {}};
  cv::Mat1f depth_m(frame.kind.size(), 0.0F), smooth_m;
  cv::medianBlur(frame.depth, smooth_m, kCompletedView.median_px);
  // From the lowest row upward, so that the depth at the feet of an upright surface is known.
  for (int y = frame.kind.rows - 1; y >= 0; --y)
    for (int x = 0; x < width; ++x) {
      float& z = depth_m(y, x);
      const float given = smooth_m(y, x);
      const bool is_ground = guide.group(y, x) == static_cast<uchar>(Group::ground);
      if (completed(y, x) == 0) {
        if (depth::DepthMap::is_solid(given)) z = given;
        continue;
      }
      if (is_ground && ground.found()) {
        if (const auto found = intersect_ground(world_from_camera, view.camera.ray({x, y}), ground))
          z = static_cast<float>(*found);
      } else if (depth::DepthMap::is_solid(given)) {
        z = given;
      }
      if (z == 0 && given != depth::DepthMap::kInfinity && y + 1 < frame.kind.rows) z = depth_m(y + 1, x);
      z = z == 0 ? static_cast<float>(kCompletedView.far_m) : std::min(z, static_cast<float>(kCompletedView.far_m));
    }
  for (const cv::Point p : Region(completed).pixels) {
    out.pixels.push_back(p.y * width + p.x);
    out.colors.emplace_back(frame.color(p));
    out.depths_m.push_back(depth_m(p));
  }
  return out;
}

ShownPixels show_completed_views(const CompletedViews& all, const Views& views, const View& view, const cv::Mat1b& wanted) {
  ShownPixels out{cv::Mat1b(wanted.size(), uchar{0}), cv::Mat3f(wanted.size(), cv::Vec3f())};
  cv::Mat1b open = wanted.clone();
  const SE3 world_from_camera = view.camera_from_world.inverse();
  for (const CompletedView& completed : all) {
    const View& from = views[completed.view];
    if (completed.pixels.empty() ||
        (from.camera_from_world.inverse().t - world_from_camera.t).norm() > kCompletedView.max_distance_m)
      continue;
    const CompletedImage image(completed, from);
    const cv::Mat1f depths = project_depths(image, from, view, open);
    const SE3 completed_from_view = from.camera_from_world * world_from_camera;
    for (int y = 0; y < depths.rows; ++y)
      for (int x = 0; x < depths.cols; ++x) {
        const float z = depths(y, x);
        if (z == 0) continue;
        const Eigen::Vector3d point = completed_from_view * (z * view.camera.ray({x, y}));
        const double depth_m = from.camera.depth(point);
        if (depth_m <= 0.1 || !from.camera.in_front(point)) continue;
        const Eigen::Vector2d at = from.camera.project(point);
        const int side = std::clamp(static_cast<int>(std::lround(z / depth_m * from.camera.fx / view.camera.fx)), 1,
                                    kCompletedView.max_footprint_px);
        const auto found = image.read(at, side);
        if (!found) continue;
        const float factor = vignetting_to(view, cv::Point2f(cv::Point(x, y)), from,
                                           cv::Point2f(static_cast<float>(at.x()), static_cast<float>(at.y())));
        const cv::Vec3f gain = gain_to(view, from);
        for (int c = 0; c < 3; ++c) out.color(y, x)[c] = std::min((*found)[c] * gain[c] * factor, 255.0F);
        out.shown(y, x) = 255;
        open(y, x) = 0;
      }
  }
  return out;
}

}  // namespace dvi::synthesize
