#include "dvi/traffic/outlines.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/traffic/seconds.h"

namespace dvi::traffic {
namespace {

constexpr double kOutlineWindow = 0.25;  // seconds each way in which an object hardly turns
constexpr double kRoof = 0.5;            // metres: windows are no higher
constexpr double kMargin = 0.05;         // metres round the returns: the ends of an object lie between rays
constexpr double kAlongside = 6;         // metres: of what is nearer, the part within the image is farther away
constexpr int kBlur = 4;                 // pixels at least: the image's own
constexpr double kPerson = 1.2;          // metres: what is longer is a vehicle

struct Body {
  std::vector<Eigen::Vector3d> points;     // world axes, at the time of the image
  std::vector<Eigen::Vector3d> footprint;  // likewise: of the ground round them
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();
};

// The returns of the scan nearest to a time, moved to it; each also put onto the ground, where wheels and
// feet are.
Body body_at(const Track& track, std::int64_t time_ns, double footprint_m) {
  const auto apart = [&](const Cluster& o) { return std::abs(seconds_from(o.mean_time_ns, time_ns)); };
  Body body;
  if (track.observations.empty()) return body;
  const auto nearest = std::min_element(track.observations.begin(), track.observations.end(),
                                        [&](const auto& a, const auto& b) { return apart(a) < apart(b); });
  if (apart(*nearest) > kOutlineWindow) return body;
  const Eigen::Vector2d velocity = track.velocity(static_cast<std::size_t>(nearest - track.observations.begin()));
  if (velocity.norm() > 1) body.heading = velocity.normalized();
  const Cluster& cluster = *nearest;
  for (std::size_t k = 0; k < cluster.points.size(); ++k) {
    Eigen::Vector3d x = cluster.points[k];
    x.head<2>() += velocity * seconds_from(cluster.time_ns[k], time_ns);
    body.points.push_back(x);
    body.points.emplace_back(x.x(), x.y(), cluster.ground[k]);
    for (const double dx : {-footprint_m, footprint_m})
      for (const double dy : {-footprint_m, footprint_m})
        body.footprint.emplace_back(x.x() + dx, x.y() + dy, cluster.ground[k]);
    // It may go on up to the next ray, but no higher than it usually is; glass below a roof returns little.
    const double top = cluster.ground[k] + track.height_m;
    const double above = x.z() > top - kRoof ? top : std::min(x.z() + cluster.rise[k], top);
    if (above > x.z()) body.points.emplace_back(x.x(), x.y(), above);
  }
  return body;
}

Box box_round(const Body& body) {
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

std::optional<Label> outline(const Track& track, std::int64_t time_ns, const Camera& camera, const SE3& world_from_lidar,
                             const SE3& camera_from_lidar, double footprint_m) {
  const Body body = body_at(track, time_ns, footprint_m);
  if (body.points.empty()) return std::nullopt;
  const SE3 lidar_from_world = world_from_lidar.inverse(), camera_from_world = camera_from_lidar * lidar_from_world;
  std::vector<Eigen::Vector3d> in_camera, on_ground;
  double nearest = 1e9;
  for (const Eigen::Vector3d& x : body.points) {
    in_camera.push_back(camera_from_world * x);
    if (in_camera.back().z() >= kNearPlane) nearest = std::min(nearest, in_camera.back().z());
  }
  for (const Eigen::Vector3d& x : body.footprint) on_ground.push_back(camera_from_world * x);
  cv::Mat1b mask(camera.height, camera.width, uchar{0});
  const bool shows = draw_hull(in_camera, camera, mask);
  if (!draw_hull(on_ground, camera, mask) && !shows) return std::nullopt;
  if (cv::countNonZero(mask) == 0) return std::nullopt;
  mask = grown(mask, std::max(kBlur, cvRound(kMargin * camera.fx / std::max(kAlongside, nearest))));
  Box box = box_round(body);
  Label label;
  label.type = box.size.head<2>().maxCoeff() > kPerson ? "vehicle" : "person";
  box.frame_from_box = lidar_from_world * box.frame_from_box;
  label.box = box;
  label.instance = outline_of(mask);
  return label;
}

}  // namespace dvi::traffic
