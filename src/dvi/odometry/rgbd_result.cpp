#include "dvi/odometry/rgbd_result.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

namespace dvi::odometry {
namespace {

constexpr double kMinLoopWeight = 0.25;          // weight in the pose graph
constexpr double kMaxInterpolatedPeriods = 2.5;  // in periods of the depth images
constexpr std::int64_t kMinGapNs = 100'000'000;  // that is interpolated over in any case
constexpr std::int64_t kMaxExtrapolationNs = 50'000'000;

/// The map with the most images.
std::optional<std::size_t> find_largest_map(const RgbdTrack& track) {
  std::map<std::size_t, std::size_t> images;
  for (const RgbdPose& pose : track.poses)
    if (pose.key) ++images[track.map_of_key[*pose.key]];
  std::optional<std::size_t> out;
  for (const auto& [map, count] : images)
    if (!out || count > images[*out]) out = map;
  return out;
}

/// Distributes the drift over the key frames of a map.
void optimize(RgbdTrack& track, std::size_t map, Odometry& out) {
  std::vector<std::size_t> keys, node(track.world_from_key.size(), 0);
  for (std::size_t k = 0; k < track.world_from_key.size(); ++k)
    if (track.map_of_key[k] == map) node[k] = keys.size(), keys.push_back(k);
  std::vector<scan_match::PoseEdge> edges;
  for (const scan_match::PoseEdge& edge : track.edges)
    if (track.map_of_key[edge.a] == map && track.map_of_key[edge.b] == map) {
      edges.push_back(edge);
      edges.back().a = node[edge.a];
      edges.back().b = node[edge.b];
    }
  if (std::none_of(edges.begin(), edges.end(), [](const scan_match::PoseEdge& edge) { return edge.uncertain; })) return;
  std::vector<SE3> poses;
  for (const std::size_t k : keys) poses.push_back(track.world_from_key[k]);
  const std::vector<double> weights = scan_match::solve_pose_graph(poses, edges);
  for (std::size_t e = 0; e < edges.size(); ++e) out.loops += edges[e].uncertain && weights[e] > kMinLoopWeight ? 1 : 0;
  for (std::size_t n = 0; n < keys.size(); ++n) {
    SE3& pose = track.world_from_key[keys[n]];
    out.largest_correction_m = std::max(out.largest_correction_m, (poses[n].t - pose.t).norm());
    pose = poses[n];
  }
}

/// The poses of the camera at the times of the color images.
class CameraPath {
 public:
  CameraPath(const RgbdTrack& track, std::size_t map) : track_(track) {
    for (const RgbdPose& pose : track.poses) {
      const bool known = pose.key && track.map_of_key[*pose.key] == map;
      poses_.push_back(known ? std::optional(track.world_from_key[*pose.key] * pose.key_from_camera) : std::nullopt);
    }
  }

  const std::optional<SE3>& operator[](std::size_t i) const { return poses_[i]; }

  /// Returns the pose at the time of the depth image of moment i, which must have a pose.
  SE3 at_depth(std::size_t i) const {
    const double delay = track_.moments[i].depth_delay_s;
    if (delay == 0) return *poses_[i];
    std::size_t other = delay > 0 ? i + 1 : i - 1;  // may wrap around, which is not a valid index either
    if (!has_pose(other)) other = delay > 0 ? i - 1 : i + 1;
    if (!has_pose(other)) return *poses_[i] * se3_exp(track_.poses[i].twist * delay);
    const double period = to_seconds(track_.moments[other].time_ns - track_.moments[i].time_ns);
    if (std::abs(period) < std::abs(delay)) return *poses_[i] * se3_exp(track_.poses[i].twist * delay);
    return interpolate(*poses_[i], *poses_[other], delay / period);
  }

 private:
  bool has_pose(std::size_t i) const { return i < poses_.size() && poses_[i].has_value(); }

  const RgbdTrack& track_;
  std::vector<std::optional<SE3>> poses_;
};

std::int64_t compute_max_gap(const Drive& drive) {
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < drive.scan_headers.size(); ++i)
    periods.push_back(drive.scan_headers[i].time_ns - drive.scan_headers[i - 1].time_ns);
  if (periods.empty()) return kMinGapNs;
  std::nth_element(periods.begin(), periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2), periods.end());
  const double gap = kMaxInterpolatedPeriods * static_cast<double>(periods[periods.size() / 2]);
  return std::clamp(static_cast<std::int64_t>(gap), kMinGapNs, Trajectory().max_gap);
}

void set_trajectory(const Drive& drive, const RgbdTrack& track, const CameraPath& path, Odometry& out) {
  std::vector<StampedPose> poses;
  std::vector<std::int64_t> lost_ns;
  for (std::size_t i = 0; i < track.moments.size(); ++i) {
    const std::int64_t depth_time = drive.scan_headers[track.moments[i].scan_index].time_ns;
    if (!path[i]) {
      lost_ns.push_back(depth_time);
      continue;
    }
    poses.push_back({depth_time, path.at_depth(i) * drive.camera_from_lidar});
    poses.push_back({track.moments[i].time_ns, *path[i] * drive.camera_from_lidar});
  }
  if (poses.empty()) return;
  const SE3 first_from_world = poses.front().world_from_body.inverse();
  Trajectory trajectory = exclude_times(std::move(poses), lost_ns).in(first_from_world);
  trajectory.max_gap = std::min(trajectory.max_gap, compute_max_gap(drive));
  trajectory.max_extrapolation = std::min(trajectory.max_extrapolation, kMaxExtrapolationNs);
  out.world_from_lidar = std::move(trajectory);
}

void set_scans(const Drive& drive, const RgbdTrack& track, const CameraPath& path, Odometry& out) {
  using State = ScanFit::State;
  out.scans.resize(drive.scan_headers.size());
  std::size_t lost = 0, first_lost = 0;
  bool first = true;
  for (std::size_t i = 0; i < track.poses.size(); ++i) {
    const RgbdPose& pose = track.poses[i];
    ScanFit& fit = out.scans[track.moments[i].scan_index];
    fit.features = pose.points;
    fit.inliers = pose.inliers;
    fit.residual_m = pose.residual_m;
    fit.information = pose.information;
    fit.state = !path[i] ? State::lost : std::exchange(first, false) ? State::first : State::registered;
    out.plane_features += pose.points;
    if (fit.state == State::lost && lost++ == 0) first_lost = track.moments[i].scan_index;
  }
  if (lost > 0)
    out.warnings.push_back(
        fmt::format("{} of {} depth images could not be aligned to the others reliably and have no pose (the first: {}): their "
                    "images are left out",
                    lost, out.scans.size(), drive.scan_headers[first_lost].name));
}

}  // namespace

Trajectory exclude_times(std::vector<StampedPose> poses, const std::vector<std::int64_t>& lost_ns) {
  Trajectory out(std::move(poses));
  if (out.empty()) return out;
  const std::vector<StampedPose>& known = out.poses();
  for (const std::int64_t lost : lost_ns) {
    const auto after = std::partition_point(known.begin(), known.end(), [&](const StampedPose& p) { return p.time_ns < lost; });
    if (after == known.end())
      out.max_extrapolation = std::min(out.max_extrapolation, lost - known.back().time_ns - 1);
    else if (after == known.begin())
      out.max_extrapolation = std::min(out.max_extrapolation, after->time_ns - lost - 1);
    else
      out.max_gap = std::min(out.max_gap, after->time_ns - (after - 1)->time_ns - 1);
  }
  return out;
}

Odometry to_odometry(const Drive& drive, RgbdTrack track) {
  Odometry out;
  out.rings = "none";
  const std::optional<std::size_t> map = find_largest_map(track);
  if (map) optimize(track, *map, out);
  const CameraPath path(track, map.value_or(0));
  set_scans(drive, track, path, out);
  set_trajectory(drive, track, path, out);
  return out;
}

}  // namespace dvi::odometry
