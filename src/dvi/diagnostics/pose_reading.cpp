#include "dvi/diagnostics/pose_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "dvi/core/median.h"

namespace dvi::diagnostics {
namespace {

constexpr std::size_t kScansApart = 4;  // scans: motion well above the noise of registration
constexpr double kLeastMotion = 0.3;    // meters between them, rotation at kArm counted in
constexpr double kArm = 5;              // meters: at which a rotation is as much motion as a translation
constexpr std::size_t kFewestSteps = 5;
// Given poses that are right disagree by some hundredths; of two that contradict each other, one by 1 or more.
constexpr double kWrong = 0.5, kRight = 0.25;
constexpr double kMinTurn = 0.003;                 // radians between them: well above the noise of registration
constexpr double kOtherTurn = 1, kSameTurn = 0.5;  // of turn_disagreement, likewise
constexpr double kMinScaleLog = 0.2;               // of a factor: positions in other units

struct Step {
  SE3 scans, from, to;  // earlier_from_later by the scans; the given poses
};

double size_of(const SE3& motion) { return motion.t.norm() + kArm * so3_log(motion.R).norm(); }

std::vector<Step> steps_of(const Trajectory& given, const std::vector<ScanTrack>& tracks) {
  std::vector<Step> out;
  for (const ScanTrack& track : tracks) {
    const std::vector<StampedPose>& poses = track.world_from_lidar.poses();
    for (std::size_t i = 0; i + kScansApart < poses.size(); ++i) {
      const SE3 motion = poses[i].world_from_body.inverse() * poses[i + kScansApart].world_from_body;
      const auto from = given.at(poses[i].time_ns), to = given.at(poses[i + kScansApart].time_ns);
      if (from && to && size_of(motion) >= kLeastMotion) out.push_back({motion, *from, *to});
    }
  }
  return out;
}

using Reading = std::function<SE3(const SE3&)>;  // world_from_lidar of a given pose

double disagreement(const std::vector<Step>& steps, const Reading& read) {
  double off = 0, all = 0;
  for (const Step& step : steps) {
    off += size_of(step.scans.inverse() * (read(step.from).inverse() * read(step.to)));
    all += size_of(step.scans);
  }
  return off / all;
}

/// The same for rotations alone; none where the drive hardly turns. On a straight road, poses of axes that are upside down move
/// as they should, and turn the other way.
std::optional<double> turn_disagreement(const std::vector<Step>& steps, const Reading& read) {
  double off = 0, all = 0;
  for (const Step& step : steps) {
    off += so3_log(step.scans.R.transpose() * (read(step.from).R.transpose() * read(step.to).R)).norm();
    all += so3_log(step.scans.R).norm();
  }
  if (all < kMinTurn * static_cast<double>(steps.size())) return std::nullopt;
  return off / all;
}

std::string axis_name(const Eigen::Vector3d& axis) {
  static constexpr std::array<const char*, 3> kAlong{"forward", "left", "up"}, kAgainst{"backward", "right", "down"};
  Eigen::Index which = 0;
  axis.cwiseAbs().maxCoeff(&which);
  return axis[which] > 0 ? kAlong[which] : kAgainst[which];
}

/// The 23 ways to turn right-handed axes onto each other.
std::vector<Eigen::Matrix3d> turned_axes() {
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

/// Rotations whose quaternion was written w first and read w last. The sign of a quaternion does not matter.
SE3 with_w_first(const SE3& pose) {
  const Eigen::Quaterniond q(pose.R);
  return {Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()).toRotationMatrix(), pose.t};
}

/// By how much given positions are to be multiplied to move as far as the scans do.
double scale_of(const std::vector<Step>& steps) {
  std::vector<double> scales;
  for (const Step& step : steps)
    if (const double given_m = (step.to.t - step.from.t).norm(); given_m > 0) scales.push_back(step.scans.t.norm() / given_m);
  return median(std::move(scales));
}

}  // namespace

std::optional<PoseReading> better_reading(const Trajectory& given, const SE3& camera_from_lidar,
                                          const std::vector<ScanTrack>& tracks) {
  const std::vector<Step> steps = steps_of(given, tracks);
  if (steps.size() < kFewestSteps) return std::nullopt;
  PoseReading out;
  out.as_given = disagreement(steps, [](const SE3& pose) { return pose; });
  constexpr const char* kWrittenWFirst = "the given poses look as if their quaternions were written w first: write qx qy qz qw";
  if (out.as_given < kWrong) {
    const auto given_turn = turn_disagreement(steps, [](const SE3& pose) { return pose; });
    const auto read_turn = turn_disagreement(steps, with_w_first);
    if (!given_turn || *given_turn < kOtherTurn || *read_turn > kSameTurn) return std::nullopt;
    return PoseReading{kWrittenWFirst, *given_turn, *read_turn};
  }
  out.as_read = kRight * out.as_given;
  const auto offer = [&](const Reading& read, const std::string& words) {
    const double off = disagreement(steps, read);
    if (off >= out.as_read || off >= kRight) return false;
    out.words = words, out.as_read = off;
    return true;
  };
  // From the mistake that is made most to the rarest; on a straight road several explain the same motion.
  if (offer([](const SE3& pose) { return pose.inverse(); }, "the given poses look inverted: write world_from_lidar") ||
      offer([&](const SE3& pose) { return pose * camera_from_lidar; },
            "the given poses look like the camera's: write world_from_lidar = world_from_camera * camera_from_lidar") ||
      offer([&](const SE3& pose) { return pose.inverse() * camera_from_lidar; },
            "the given poses look like the camera's, inverted (camera_from_world): write world_from_lidar = "
            "camera_from_world^-1 * camera_from_lidar") ||
      offer(
          [&](const SE3& pose) { return pose * camera_from_lidar.inverse(); },
          "the given poses look like the LiDAR's, read as the camera's: a file of 12 numbers per line holds world_from_camera; "
          "write the name of the scan, or @ and its time in seconds, before the 12 numbers") ||
      offer(with_w_first, kWrittenWFirst))
    return out;
  if (const double scale = scale_of(steps); scale > 0 && std::abs(std::log(scale)) > kMinScaleLog)
    if (offer([&](const SE3& pose) { return SE3{pose.R, scale * pose.t}; },
              fmt::format("the given poses move {:.4g} times as far as the scans: write positions in meters", 1 / scale)))
      return out;
  for (const Eigen::Matrix3d& lidar_from_body : turned_axes())
    offer([&](const SE3& pose) { return pose * SE3{lidar_from_body.transpose(), Eigen::Vector3d::Zero()}; },
          fmt::format("the given poses look like those of axes x {}, y {}, z {}: write poses of the LiDAR's axes, x forward, y "
                      "left, z up",
                      axis_name(lidar_from_body.col(0)), axis_name(lidar_from_body.col(1)), axis_name(lidar_from_body.col(2))));
  return out.words.empty() ? std::nullopt : std::optional(out);
}

}  // namespace dvi::diagnostics
