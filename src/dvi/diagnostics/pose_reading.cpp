#include "dvi/diagnostics/pose_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "dvi/core/median.h"

namespace dvi::diagnostics {
namespace {

struct PoseStep {
  SE3 scans, from, to;  // earlier_from_later by the scans; the given poses
};

double measure_motion_m(const SE3& motion) { return motion.t.norm() + kPoseReading.lever_arm_m * so3_log(motion.R).norm(); }

std::vector<PoseStep> collect_steps(const Trajectory& given, const std::vector<ScanTrack>& tracks) {
  std::vector<PoseStep> out;
  for (const ScanTrack& track : tracks) {
    const std::vector<StampedPose>& poses = track.world_from_lidar.poses();
    for (std::size_t i = 0; i + kPoseReading.scan_step < poses.size(); ++i) {
      const SE3 motion = poses[i].world_from_body.inverse() * poses[i + kPoseReading.scan_step].world_from_body;
      const auto from = given.at(poses[i].time_ns), to = given.at(poses[i + kPoseReading.scan_step].time_ns);
      if (from && to && measure_motion_m(motion) >= kPoseReading.min_motion_m) out.push_back({motion, *from, *to});
    }
  }
  return out;
}

using Reading = std::function<SE3(const SE3&)>;  // converts a given pose to world_from_lidar

double compute_difference(const std::vector<PoseStep>& steps, const Reading& read) {
  double off = 0, all = 0;
  for (const PoseStep& step : steps) {
    off += measure_motion_m(step.scans.inverse() * (read(step.from).inverse() * read(step.to)));
    all += measure_motion_m(step.scans);
  }
  return off / all;
}

/// The same for rotations alone; nothing if the drive hardly turns. On a straight road, poses with axes that are upside down
/// have the right translations and the opposite rotations.
std::optional<double> compute_turn_difference(const std::vector<PoseStep>& steps, const Reading& read) {
  double off = 0, all = 0;
  for (const PoseStep& step : steps) {
    off += so3_log(step.scans.R.transpose() * (read(step.from).R.transpose() * read(step.to).R)).norm();
    all += so3_log(step.scans.R).norm();
  }
  if (all < kPoseReading.min_turn_rad * static_cast<double>(steps.size())) return std::nullopt;
  return off / all;
}

std::string name_axis(const Eigen::Vector3d& axis) {
  static constexpr std::array<const char*, 3> kPositive{"forward", "left", "up"}, kNegative{"backward", "right", "down"};
  Eigen::Index which = 0;
  axis.cwiseAbs().maxCoeff(&which);
  return axis[which] > 0 ? kPositive[which] : kNegative[which];
}

/// Lists the 23 rotations that permute right-handed axes.
std::vector<Eigen::Matrix3d> list_axis_rotations() {
  std::vector<Eigen::Matrix3d> out;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y) {
      if (x % 3 == y % 3) continue;
      const Eigen::Vector3d a = (x < 3 ? 1 : -1) * Eigen::Vector3d::Unit(x % 3),
                            b = (y < 3 ? 1 : -1) * Eigen::Vector3d::Unit(y % 3);
      Eigen::Matrix3d lidar_from_body;
      lidar_from_body << a, b, a.cross(b);
      if (!lidar_from_body.isIdentity()) out.push_back(lidar_from_body);
    }
  return out;
}

/// Corrects a rotation whose quaternion was written w first and read w last. The sign of a quaternion does not matter.
SE3 reorder_quaternion(const SE3& pose) {
  const Eigen::Quaterniond q(pose.R);
  return {Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix(), pose.t};
}

/// Estimates the factor for the given positions, so that they move as far as the scans do.
double estimate_scale(const std::vector<PoseStep>& steps) {
  std::vector<double> scales;
  for (const PoseStep& step : steps)
    if (const double given_m = (step.to.t - step.from.t).norm(); given_m > 0) scales.push_back(step.scans.t.norm() / given_m);
  return median(std::move(scales));
}

}  // namespace

std::optional<PoseReading> find_better_reading(const Trajectory& given, const SE3& camera_from_lidar,
                                               const std::vector<ScanTrack>& tracks) {
  const std::vector<PoseStep> steps = collect_steps(given, tracks);
  if (steps.size() < kPoseReading.min_steps) return std::nullopt;
  PoseReading out;
  out.as_given = compute_difference(steps, [](const SE3& pose) { return pose; });
  constexpr const char* kWFirstMessage = "the quaternions of the given poses seem to be written w first: write qx qy qz qw";
  if (out.as_given < kPoseReading.min_wrong) {
    const auto given_turn = compute_turn_difference(steps, [](const SE3& pose) { return pose; });
    const auto read_turn = compute_turn_difference(steps, reorder_quaternion);
    if (!given_turn || *given_turn < kPoseReading.min_wrong_turn || *read_turn > kPoseReading.max_right_turn)
      return std::nullopt;
    return PoseReading{kWFirstMessage, *given_turn, *read_turn};
  }
  out.as_read = kPoseReading.max_right * out.as_given;
  const auto try_reading = [&](const Reading& read, const std::string& words) {
    const double off = compute_difference(steps, read);
    if (off >= out.as_read || off >= kPoseReading.max_right) return false;
    out.words = words, out.as_read = off;
    return true;
  };
  // From the most frequent mistake to the rarest: on a straight road, several explain the same motion.
  if (try_reading([](const SE3& pose) { return pose.inverse(); },
                  "the given poses seem to be inverted: write world_from_lidar") ||
      try_reading([&](const SE3& pose) { return pose * camera_from_lidar; },
                  "the given poses seem to be of the camera: write world_from_lidar = world_from_camera * camera_from_lidar") ||
      try_reading([&](const SE3& pose) { return pose.inverse() * camera_from_lidar; },
                  "the given poses seem to be inverted poses of the camera (camera_from_world): write world_from_lidar = "
                  "camera_from_world^-1 * camera_from_lidar") ||
      try_reading([&](const SE3& pose) { return pose * camera_from_lidar.inverse(); },
                  "the given poses seem to be of the LiDAR, read as poses of the camera: a file of 12 numbers per line has "
                  "world_from_camera; write the name of the scan, or @ and its time in seconds, before the 12 numbers") ||
      try_reading(reorder_quaternion, kWFirstMessage))
    return out;
  if (const double scale = estimate_scale(steps); scale > 0 && std::abs(std::log(scale)) > kPoseReading.min_scale_log)
    if (try_reading([&](const SE3& pose) { return SE3{pose.R, scale * pose.t}; },
                    fmt::format("the given poses move {:.4g} times as far as the scans: write positions in meters", 1 / scale)))
      return out;
  for (const Eigen::Matrix3d& lidar_from_body : list_axis_rotations())
    try_reading(
        [&](const SE3& pose) { return pose * SE3{lidar_from_body.transpose(), Eigen::Vector3d::Zero()}; },
        fmt::format("the given poses seem to be in axes x {}, y {}, z {}: write poses in LiDAR axes, x forward, y "
                    "left, z up",
                    name_axis(lidar_from_body.col(0)), name_axis(lidar_from_body.col(1)), name_axis(lidar_from_body.col(2))));
  return out.words.empty() ? std::nullopt : std::optional(out);
}

}  // namespace dvi::diagnostics
