#include "dvi/holdout/driven_path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/core/threads.h"

namespace dvi::holdout {
namespace {

constexpr double kMinPathM = 1;        // a shorter path has no direction
constexpr double kExtrapolationM = 5;  // part of the path at an end whose curvature continues beyond it
constexpr double kTangentM = 2;        // half the length of the chord

/// Selects the returns in the vehicle's lane: distance ahead and height relative to the LiDAR.
std::vector<Eigen::Vector2d> select_lane(const Scan& scan, const Eigen::Vector3d& ahead) {
  const Eigen::Vector2f forward = ahead.head<2>().normalized().cast<float>(), side(-forward.y(), forward.x());
  std::vector<Eigen::Vector2d> lane;
  for (const Eigen::Vector3f& p : scan.points) {
    const float distance = forward.dot(p.head<2>());
    if (std::abs(distance) < kLaneGround.min_distance_m || std::abs(distance) > kLaneGround.max_distance_m ||
        std::abs(side.dot(p.head<2>())) > kLaneGround.half_width_m)
      continue;
    if (p.z() < kLaneGround.max_height_m && p.z() > kLaneGround.min_height_m) lane.emplace_back(distance, p.z());
  }
  return lane;
}

/// Finds the most frequent height of the returns within 15 m.
std::optional<double> find_mode_of_heights(const std::vector<Eigen::Vector2d>& lane) {
  std::vector<int> bins(51, 0);
  for (const Eigen::Vector2d& p : lane)
    if (std::abs(p.x()) < kLaneGround.histogram_range_m) ++bins[static_cast<std::size_t>(-p.y() / kLaneGround.bin_m)];
  const auto most = std::max_element(bins.begin(), bins.end());
  if (*most == 0) return std::nullopt;
  return -kLaneGround.bin_m * (0.5 + static_cast<double>(most - bins.begin()));
}

/// Fits z = line.x + line.y * distance to the ground of the lane, over increasing distances.
std::optional<Eigen::Vector2d> fit_ground(const Scan& scan, const Eigen::Vector3d& ahead) {
  const std::vector<Eigen::Vector2d> lane = select_lane(scan, ahead);
  const std::optional<double> start = find_mode_of_heights(lane);
  if (!start) return std::nullopt;
  Eigen::Vector2d line(*start, 0);
  for (const double max_distance : {8.0, 15.0, 30.0, 30.0}) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& p : lane) {
      const Eigen::Vector2d row(1, p.x());
      if (std::abs(p.x()) > max_distance || std::abs(p.y() - row.dot(line)) > kLaneGround.max_residual_m) continue;
      normal += row * row.transpose();
      right += p.y() * row;
    }
    if (normal(0, 0) < kLaneGround.min_inliers || normal.determinant() < normal(0, 0) * normal(0, 0))
      break;  // spread below a meter
    const Eigen::Vector2d better = normal.inverse() * right;
    if (std::abs(better.y()) > kLaneGround.max_slope) break;
    line = better;
  }
  return line;
}

}  // namespace

DrivenPath::DrivenPath(const Drive& drive, const Trajectory& world_from_lidar) : world_from_lidar_(world_from_lidar) {
  const std::vector<StampedPose>& poses = world_from_lidar_.poses();
  double meters = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) meters += (poses[i].world_from_body.t - poses[i - 1].world_from_body.t).norm();
    meters_.push_back(meters);
  }
  const SE3& first = poses.front().world_from_body;
  const Eigen::Vector3d up = first.R.col(2), view = first.R * drive.camera_from_lidar.R.row(2).transpose();
  ahead_ = (view - view.dot(up) * up).normalized();
  measure_ground(drive);
}

void DrivenPath::measure_ground(const Drive& drive) {
  std::vector<std::optional<Eigen::Vector2d>> lines(drive.scan_headers.size());
  parallel_for(lines.size(), [&](std::size_t i) {
    const std::int64_t time = drive.scan_headers[i].time_ns;
    if (const std::optional<SE3> pose = world_from_lidar_.at(time))
      lines[i] = fit_ground(*drive.scans[i], pose->R.transpose() * tangent(path_length_at(time)));
  });
  std::vector<StampedGround> found;
  std::vector<double> heights;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i]) continue;
    found.push_back({drive.scan_headers[i].time_ns, {-lines[i]->x(), lines[i]->y()}});
    heights.push_back(-lines[i]->x());
  }
  if (found.empty())
    throw InputError(drive.path, "its scans show no ground within 15 m of the LiDAR",
                     "virtual traffic requires a LiDAR whose scans show the road");
  sensor_height_ = median(std::move(heights));

  constexpr std::size_t kNeighbors = kLaneGround.smoothing_scans;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::size_t begin = i - std::min(i, kNeighbors), end = std::min(i + kNeighbors + 1, found.size());
    StampedGround mean{found[i].time_ns, {}};
    for (std::size_t k = begin; k < end; ++k) {
      mean.ground.height += found[k].ground.height / static_cast<double>(end - begin);
      mean.ground.slope += found[k].ground.slope / static_cast<double>(end - begin);
    }
    grounds_.push_back(mean);
  }
}

DrivenPath::GroundLine DrivenPath::ground_at(std::int64_t time_ns) const {
  const auto after = std::upper_bound(grounds_.begin(), grounds_.end(), time_ns,
                                      [](std::int64_t time, const StampedGround& g) { return time < g.time_ns; });
  if (after == grounds_.begin()) return grounds_.front().ground;
  if (after == grounds_.end()) return grounds_.back().ground;
  const StampedGround &a = *(after - 1), &b = *after;
  const double u = static_cast<double>(time_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
  return {a.ground.height + u * (b.ground.height - a.ground.height), a.ground.slope + u * (b.ground.slope - a.ground.slope)};
}

double DrivenPath::path_length_at(std::int64_t time_ns) const {
  const std::vector<StampedPose>& poses = world_from_lidar_.poses();
  const auto after = std::upper_bound(poses.begin(), poses.end(), time_ns,
                                      [](std::int64_t time, const StampedPose& p) { return time < p.time_ns; });
  if (after == poses.begin()) return meters_.front();
  if (after == poses.end()) return meters_.back();
  const auto i = static_cast<std::size_t>(after - poses.begin());
  const double u =
      static_cast<double>(time_ns - poses[i - 1].time_ns) / static_cast<double>(poses[i].time_ns - poses[i - 1].time_ns);
  return meters_[i - 1] + u * (meters_[i] - meters_[i - 1]);
}

SE3 DrivenPath::lidar_within(double along) const {
  const std::vector<StampedPose>& poses = world_from_lidar_.poses();
  const auto after = std::upper_bound(meters_.begin(), meters_.end(), along);
  if (after == meters_.begin()) return poses.front().world_from_body;
  if (after == meters_.end()) return poses.back().world_from_body;
  const auto i = static_cast<std::size_t>(after - meters_.begin());
  return interpolate(poses[i - 1].world_from_body, poses[i].world_from_body,
                     (along - meters_[i - 1]) / (meters_[i] - meters_[i - 1]));
}

SE3 DrivenPath::lidar_at(double along) const {
  if (length() < kMinPathM) {
    const SE3& first = world_from_lidar_.poses().front().world_from_body;
    return {first.R, first.t + along * ahead_};
  }
  const double base = std::min(kExtrapolationM, length());
  if (along < 0) return interpolate(lidar_within(0), lidar_within(base), along / base);
  if (along > length())
    return interpolate(lidar_within(length() - base), lidar_within(length()), 1 + (along - length()) / base);
  return lidar_within(along);
}

Eigen::Vector3d DrivenPath::tangent(double along) const {
  return lidar_at(along + kTangentM).t - lidar_at(along - kTangentM).t;
}

SE3 DrivenPath::road_pose(double along, double left, std::int64_t time_ns) const {
  const SE3 there = lidar_at(along), now = world_from_lidar_.at(time_ns).value_or(there);
  const GroundLine ground = ground_at(time_ns);
  // In the LiDAR axes at this time, the ground is a plane that rises ahead.
  const Eigen::Vector3d forward = now.R.transpose() * tangent(path_length_at(time_ns));
  const Eigen::Vector3d rise(ground.slope * forward.x() / forward.head<2>().norm(),
                             ground.slope * forward.y() / forward.head<2>().norm(), 0);
  const Eigen::Vector3d up = (Eigen::Vector3d::UnitZ() - rise).normalized();
  const Eigen::Vector3d ahead = now.R.transpose() * tangent(along);
  SE3 lidar_from_road;
  lidar_from_road.R.col(0) = (ahead - ahead.dot(up) * up).normalized();
  lidar_from_road.R.col(1) = up.cross(lidar_from_road.R.col(0));
  lidar_from_road.R.col(2) = up;
  lidar_from_road.t = now.inverse() * there.t + left * lidar_from_road.R.col(1);
  lidar_from_road.t.z() = rise.dot(lidar_from_road.t) - ground.height;
  return now * lidar_from_road;
}

}  // namespace dvi::holdout
