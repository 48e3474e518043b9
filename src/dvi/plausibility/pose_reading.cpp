#include "dvi/plausibility/pose_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>

namespace dvi::plausibility {
namespace {

constexpr std::size_t kScansApart = 4;  // scans: motion well above the noise of registration
constexpr double kLeastMotion = 0.3;    // metres between them, rotation at kArm counted in
constexpr double kArm = 5;              // metres: at which a rotation is as much motion as a translation
constexpr std::size_t kFewestSteps = 5;
// Given poses that are right disagree by some hundredths; of two that contradict each other, one by 1 or more.
constexpr double kWrong = 0.5, kRight = 0.25;

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

}  // namespace

std::optional<PoseReading> better_reading(const Trajectory& given, const SE3& camera_from_lidar,
                                          const std::vector<ScanTrack>& tracks) {
  const std::vector<Step> steps = steps_of(given, tracks);
  if (steps.size() < kFewestSteps) return std::nullopt;
  PoseReading out;
  out.as_given = disagreement(steps, [](const SE3& pose) { return pose; });
  if (out.as_given < kWrong) return std::nullopt;
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
            "camera_from_world^-1 * camera_from_lidar"))
    return out;
  for (const Eigen::Matrix3d& lidar_from_body : turned_axes())
    offer([&](const SE3& pose) { return pose * SE3{lidar_from_body.transpose(), Eigen::Vector3d::Zero()}; },
          fmt::format("the given poses look like those of axes x {}, y {}, z {}: write poses of the LiDAR's axes, x forward, y "
                      "left, z up",
                      axis_name(lidar_from_body.col(0)), axis_name(lidar_from_body.col(1)), axis_name(lidar_from_body.col(2))));
  return out.words.empty() ? std::nullopt : std::optional(out);
}

}  // namespace dvi::plausibility
