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

constexpr double kOutlineWindow = 0.25;    // seconds each way in which an object hardly turns
constexpr double kRoof = 0.5;              // meters: windows are no higher
constexpr double kShape = kRoof / 3;       // meters between rays: above, so few hit a window that a lost one hides the shape
constexpr std::size_t kFewestPlaced = 20;  // returns so far apart that place an object: of fewer, single wrong ones move it
constexpr double kMargin = 0.05;           // meters round the returns: the ends of an object lie between rays
constexpr double kMirror = 0.2;            // meters beside the returns: what sticks out between rays
constexpr double kAlongside = 6;           // meters: of what is nearer, the part within the image is farther away
constexpr int kBlur = 4;                   // pixels at least: the image's own
constexpr double kPerson = 1.2;            // meters: what is longer is a vehicle

struct Body {
  std::vector<Eigen::Vector3d> points;  // world axes, at the time of the image
  std::vector<Eigen::Vector3d> feet;    // likewise: the ground below them
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();
  bool shapeless = false;  // rays are too far apart to show where it ends
};

// Grows an interval to a length, away from the sensor: the face toward it is the one that its rays hit.
void lengthen(double& low, double& high, double length, double sensor) {
  const double lacking = length - (high - low);
  if (lacking <= 0) return;
  const double share = sensor < low ? 1 : sensor > high ? 0 : 0.5;
  high += share * lacking;
  low -= (1 - share) * lacking;
}

// The corners of the box of the whole object that these returns are part of.
void add_whole(const Track& track, double ground, const Eigen::Vector2d& sensor, Body& body) {
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

// The returns of the scan nearest to a time, moved to it; each also put onto the ground, where wheels and feet are. Where rays
// are too far apart to show a shape, with the whole box, and also for a while before and after they hit it at all.
Body body_at(const Track& track, std::int64_t time_ns, const Eigen::Vector2d& sensor) {
  Body body;
  if (track.observations.empty()) return body;
  const std::size_t nearest = track.nearest(time_ns);
  const Cluster& cluster = track.observations[nearest];
  const double apart = std::abs(seconds_from(cluster.mean_time_ns, time_ns));
  const Eigen::Vector2d velocity = track.velocity(nearest);
  const std::optional<Eigen::Vector2d> heading = track.heading(nearest);
  const bool boxed = heading && median(cluster.rise) > kShape;
  body.shapeless = median(cluster.rise) > kShape;
  if (apart > (boxed ? kGoesOn : kOutlineWindow)) return body;
  if (heading) body.heading = *heading;
  const bool upright = track.size_m.maxCoeff() > 0 && track.size_m.maxCoeff() <= kPerson;
  for (std::size_t k = 0; k < cluster.points.size(); ++k) {
    Eigen::Vector3d x = cluster.points[k];
    x.head<2>() += velocity * seconds_from(cluster.time_ns[k], time_ns);
    body.points.push_back(x);
    body.feet.emplace_back(x.x(), x.y(), cluster.ground[k]);
    // It may go on up to the next ray, but no higher than it usually is; glass below a roof returns little, and so does hair.
    // A head ends half the distance between rays above the highest that hits it, more or less by as much; a roof is flat. Not
    // where rays are so far apart that the half is more than a head.
    const double top = cluster.ground[k] + track.height_m + (upright && !body.shapeless ? 0.5 * cluster.rise[k] : 0);
    const double above = upright || x.z() > top - kRoof ? top : std::min(x.z() + cluster.rise[k], top);
    if (above > x.z()) body.points.emplace_back(x.x(), x.y(), above);
  }
  if (boxed) add_whole(track, median(cluster.ground), sensor, body);
  body.points.insert(body.points.end(), body.feet.begin(), body.feet.end());
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

ScanEvidence shown_by_scans(const Track& track, std::int64_t time_ns) {
  if (track.observations.empty()) return ScanEvidence::no;
  const Cluster& nearest = track.observations[track.nearest(time_ns)];
  if (std::abs(seconds_from(nearest.mean_time_ns, time_ns)) > kOutlineWindow) return ScanEvidence::no;
  return nearest.points.size() < kFewestPlaced && median(nearest.rise) > kShape ? ScanEvidence::poorly : ScanEvidence::well;
}

std::optional<Label> outline(const Track& track, std::int64_t time_ns, const Camera& camera, const SE3& world_from_lidar,
                             const SE3& camera_from_lidar, double footprint_m) {
  const Body body = body_at(track, time_ns, world_from_lidar.t.head<2>());
  if (body.points.empty()) return std::nullopt;
  const SE3 lidar_from_world = world_from_lidar.inverse(), camera_from_world = camera_from_lidar * lidar_from_world;
  std::vector<Eigen::Vector3d> in_camera, below;
  double nearest = 1e9;
  for (const Eigen::Vector3d& x : body.points) {
    in_camera.push_back(camera_from_world * x);
    if (in_camera.back().z() >= kNearPlane) nearest = std::min(nearest, in_camera.back().z());
  }
  for (const Eigen::Vector3d& x : body.feet)
    for (const double dx : {-footprint_m, footprint_m})
      for (const double dy : {-footprint_m, footprint_m}) below.push_back(camera_from_world * (x + Eigen::Vector3d(dx, dy, 0)));
  // Beside a body there is nothing above the ground round it; but only returns close to each other show where the body ends.
  cv::Mat1b mask(camera.height, camera.width, uchar{0}), ground = mask.clone(), both = mask.clone();
  const bool seen = draw_hull(in_camera, camera, mask), stands = draw_hull(below, camera, ground);
  if (!seen && !stands) return std::nullopt;
  const auto pixels = [&](double meters) {
    return std::max(kBlur, cvRound(meters * camera.fx / std::max(kAlongside, nearest)));
  };
  cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * pixels(kMirror) + 1, 2 * pixels(kMargin) + 1}));
  mask |= grown(ground, pixels(kMargin));
  in_camera.insert(in_camera.end(), below.begin(), below.end());
  draw_hull(in_camera, camera, both);
  both = grown(both, pixels(kMargin));
  mask = body.shapeless ? both : cv::Mat1b(mask & both);
  if (cv::countNonZero(mask) == 0) return std::nullopt;
  Box box = box_round(body);
  Label label;
  label.type = box.size.head<2>().maxCoeff() > kPerson ? "vehicle" : "person";
  box.frame_from_box = lidar_from_world * box.frame_from_box;
  label.box = box;
  label.instance = to_outline(mask);
  return label;
}

}  // namespace dvi::objects
