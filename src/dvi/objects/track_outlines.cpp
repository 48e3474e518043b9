#include "dvi/objects/track_outlines.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct OutlineParams {
  double window_s = 0.25;               ///< time to the nearest scan; an object hardly turns within it
  double window_height_m = 0.5;         ///< height of car windows, which return few rays below the roof
  double max_ray_spacing_m = 0.5 / 3;   ///< beyond, so few rays hit a window that a missing one hides the shape
  std::size_t min_sparse_returns = 20;  ///< so far apart, fewer returns do not locate an object: single errors would move it
  double margin_m = 0.05;               ///< around the returns: the ends of an object lie between rays
  double side_margin_m = 0.2;           ///< beside the returns: mirrors and other parts between rays
  /// Smallest depth for the conversion of margins to pixels. The visible part of a nearer object is farther away than its
  /// nearest return.
  double min_margin_depth_m = 6;
  int min_margin_px = 4;      ///< blur of the image
  double max_person_m = 1.2;  ///< a longer object is a vehicle
};
constexpr OutlineParams kOutline{};

struct Body {
  std::vector<Eigen::Vector3d> points;  // world axes, at the time of the image
  std::vector<Eigen::Vector3d> feet;    // the ground below them
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();
  bool is_sparse = false;  // rays are too far apart to show the shape
};

// Extends an interval to a length, away from the sensor, because its rays hit the side that faces it.
void lengthen(double& low, double& high, double length, double sensor) {
  const double lacking = length - (high - low);
  if (lacking <= 0) return;
  const double share = sensor < low ? 1 : sensor > high ? 0 : 0.5;
  high += share * lacking;
  low -= (1 - share) * lacking;
}

// Adds the corners of the box of the whole object.
void add_box(const Track& track, double ground, const Eigen::Vector2d& sensor, Body& body) {
  const Eigen::Vector2d along = body.heading, across(-along.y(), along.x());
  Eigen::Array2d low = Eigen::Array2d::Constant(1e9), high = -low;
  for (const Eigen::Vector3d& x : body.points) {
    const Eigen::Array2d at(along.dot(x.head<2>()), across.dot(x.head<2>()));
    low = low.min(at);
    high = high.max(at);
  }
  lengthen(low.x(), high.x(), track.size_m.x(), along.dot(sensor));
  lengthen(low.y(), high.y(), track.size_m.y(), across.dot(sensor));
  for (const double a : {low.x(), high.x()})
    for (const double b : {low.y(), high.y()}) {
      const Eigen::Vector2d corner = a * along + b * across;
      body.points.emplace_back(corner.x(), corner.y(), ground + track.height_m);
      body.feet.emplace_back(corner.x(), corner.y(), ground);
    }
}

// Returns the returns of the scan nearest to a time, moved to that time, and their projections to the ground, with wheels and
// feet. If rays are too far apart to show the shape, the whole box is added, also for some time before and after the
// observations.
Body predict_body(const Track& track, std::int64_t time_ns, const Eigen::Vector2d& sensor) {
  Body body;
  if (track.observations.empty()) return body;
  const std::size_t nearest = track.nearest(time_ns);
  const Cluster& cluster = track.observations[nearest];
  const double gap_s = std::abs(seconds_between(cluster.mean_time_ns, time_ns));
  const Eigen::Vector2d velocity = track.velocity(nearest);
  const std::optional<Eigen::Vector2d> heading = track.heading(nearest);
  body.is_sparse = cluster.returns.median_ray_spacing_m() > kOutline.max_ray_spacing_m;
  const bool use_box = heading && body.is_sparse;
  if (gap_s > (use_box ? kMaxExtrapolationS : kOutline.window_s)) return body;
  if (heading) body.heading = *heading;
  const bool is_person = track.size_m.maxCoeff() > 0 && track.size_m.maxCoeff() <= kOutline.max_person_m;
  const double top_m = top_of(cluster);
  for (const ClusterReturn& r : cluster.returns) {
    Eigen::Vector3d x = r.point;
    x.head<2>() += velocity * seconds_between(r.time_ns, time_ns);
    body.points.push_back(x);
    body.feet.emplace_back(x.x(), x.y(), r.ground);
    // The object may continue up to the next ray, but not above its usual height; glass below a roof returns little, and so
    // does hair. A head ends half the ray spacing above its highest return on average, but a roof is flat. If rays are sparse,
    // the half is more than a head.
    const double top = r.ground + track.height_m + (is_person && !body.is_sparse ? 0.5 * r.ray_spacing_m : 0);
    const bool is_top = track.reaches_above_scans ? is_near_top(r, top_m) : x.z() > top - kOutline.window_height_m;
    const double above = is_person || is_top ? top : std::min(x.z() + r.ray_spacing_m, top);
    if (above > x.z()) body.points.emplace_back(x.x(), x.y(), above);
  }
  if (use_box) add_box(track, cluster.returns.median_ground(), sensor, body);
  body.points.insert(body.points.end(), body.feet.begin(), body.feet.end());
  return body;
}

Box compute_bounding_box(const Body& body) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R.col(0).head<2>() = body.heading;
  R.col(1).head<2>() = Eigen::Vector2d(-body.heading.y(), body.heading.x());
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (const Eigen::Vector3d& x : body.points) {
    low = low.cwiseMin(R.transpose() * x);
    high = high.cwiseMax(R.transpose() * x);
  }
  return {SE3{R, R * (0.5 * (low + high))}, high - low};
}

}  // namespace

ScanEvidence rate_scan_evidence(const Track& track, std::int64_t time_ns) {
  if (track.observations.empty()) return ScanEvidence::none;
  const Cluster& nearest = track.observations[track.nearest(time_ns)];
  if (std::abs(seconds_between(nearest.mean_time_ns, time_ns)) > kOutline.window_s) return ScanEvidence::none;
  const bool weak = nearest.returns.size() < kOutline.min_sparse_returns &&
                    nearest.returns.median_ray_spacing_m() > kOutline.max_ray_spacing_m;
  return weak ? ScanEvidence::weak : ScanEvidence::strong;
}

std::string type_by_size(const Eigen::Vector2d& size_m) {
  return size_m.maxCoeff() > kOutline.max_person_m ? "vehicle" : "person";
}

std::optional<Label> draw_outline(const Track& track, std::int64_t time_ns, const OutlineView& view) {
  const Camera& camera = view.camera;
  const Body body = predict_body(track, time_ns, view.world_from_lidar.t.head<2>());
  if (body.points.empty()) return std::nullopt;
  const SE3 lidar_from_world = view.world_from_lidar.inverse(), camera_from_world = view.camera_from_lidar * lidar_from_world;
  std::vector<Eigen::Vector3d> in_camera, below;
  double nearest = 1e9;
  for (const Eigen::Vector3d& x : body.points) {
    in_camera.push_back(camera_from_world * x);
    if (is_beyond_near_plane(in_camera.back(), camera)) nearest = std::min(nearest, camera.depth(in_camera.back()));
  }
  for (const Eigen::Vector3d& x : body.feet)
    for (const double dx : {-view.footprint_m, view.footprint_m})
      for (const double dy : {-view.footprint_m, view.footprint_m})
        below.push_back(camera_from_world * (x + Eigen::Vector3d(dx, dy, 0)));
  // Beside the body, only the ground belongs to the object. Sparse returns do not show where the body ends.
  cv::Mat1b mask(camera.height, camera.width, uchar{0}), ground = mask.clone(), both = mask.clone();
  const bool body_visible = draw_hull(in_camera, camera, mask), ground_visible = draw_hull(below, camera, ground);
  if (!body_visible && !ground_visible) return std::nullopt;
  const auto to_pixels = [&](double meters) {
    return std::max(kOutline.min_margin_px, cvRound(meters * camera.fx / std::max(kOutline.min_margin_depth_m, nearest)));
  };
  const int margin_px = to_pixels(kOutline.margin_m), side_margin_px = to_pixels(kOutline.side_margin_m);
  cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * side_margin_px + 1, 2 * margin_px + 1}));
  mask |= grown(ground, margin_px);
  in_camera.insert(in_camera.end(), below.begin(), below.end());
  draw_hull(in_camera, camera, both);
  both = grown(both, margin_px);
  mask = body.is_sparse ? both : cv::Mat1b(mask & both);
  if (cv::countNonZero(mask) == 0) return std::nullopt;
  Box box = compute_bounding_box(body);
  Label label;
  label.type = type_by_size(box.size.head<2>());
  box.frame_from_box = lidar_from_world * box.frame_from_box;
  label.box = box;
  label.instance = to_outline(mask);
  return label;
}

}  // namespace dvi::objects
