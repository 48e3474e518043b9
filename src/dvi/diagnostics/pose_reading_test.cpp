#include "dvi/diagnostics/pose_reading.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace dvi::diagnostics {
namespace {

using testing::HasSubstr;

/// A car with a speed in meters per second and a turn in radians per second, with ten poses per second.
Trajectory make_path(double speed, double turn) {
  std::vector<StampedPose> poses;
  SE3 pose{so3_exp({0, 0, 0.7}), {20, -30, 5}};
  Vector6d step = Vector6d::Zero();
  step[0] = 0.1 * speed, step[5] = 0.1 * turn;
  for (int i = 0; i < 20; ++i) {
    poses.push_back({i * std::int64_t{100'000'000}, pose});
    pose = pose * se3_exp(step);
  }
  return Trajectory(poses);
}

/// The motion of the scans: the same path in a world of its own.
std::vector<ScanTrack> make_tracks(const Trajectory& path) {
  return {{0, path.poses().size(), path.in(path.poses().front().world_from_body.inverse())}};
}

Trajectory change_each(const Trajectory& path, const std::function<SE3(const SE3&)>& change) {
  std::vector<StampedPose> poses = path.poses();
  for (StampedPose& p : poses) p.world_from_body = change(p.world_from_body);
  return Trajectory(poses);
}

SE3 camera_from_lidar() {
  SE3 out{Eigen::Matrix3d{{0, -1, 0}, {0, 0, -1}, {1, 0, 0}}, {0.1, -0.2, -0.3}};
  return out;
}

std::string find_reading(const Trajectory& given, const Trajectory& driven) {
  const auto found = find_better_reading(given, camera_from_lidar(), make_tracks(driven));
  return found ? found->words : "";
}

TEST(PoseReading, AcceptsCorrectPoses) {
  for (const double turn : {-0.3, 0.0, 0.3}) {
    const Trajectory driven = make_path(8, turn);
    EXPECT_EQ(find_reading(driven, driven), "");
    const Trajectory noisy = change_each(
        driven, [n = 0](const SE3& pose) mutable { return SE3{pose.R, pose.t + Eigen::Vector3d(0.05 * (n++ % 2), 0, 0)}; });
    EXPECT_EQ(find_reading(noisy, driven), "");
  }
}

TEST(PoseReading, ReportsTheConventionOfThePoses) {
  for (const double turn : {-0.3, 0.0, 0.3}) {
    const Trajectory driven = make_path(8, turn);
    EXPECT_THAT(find_reading(change_each(driven, [](const SE3& p) { return p.inverse(); }), driven), HasSubstr("inverted"));
    EXPECT_THAT(find_reading(change_each(driven, [](const SE3& p) { return p * camera_from_lidar().inverse(); }), driven),
                HasSubstr("of the camera: write"));
    EXPECT_THAT(find_reading(change_each(driven, [](const SE3& p) { return camera_from_lidar() * p.inverse(); }), driven),
                HasSubstr("camera_from_world"));
  }
  for (const double turn : {-0.3, 0.0, 0.3}) {
    const Trajectory driven = make_path(8, turn);
    const auto read_w_last = [](const SE3& p) {
      const Eigen::Quaterniond q(p.R);  // its w, x, y, z are read as x, y, z, w
      return SE3{Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix(), p.t};
    };
    EXPECT_THAT(find_reading(change_each(driven, read_w_last), driven), HasSubstr("written w first"));
    EXPECT_THAT(find_reading(change_each(driven, [](const SE3& p) { return p * camera_from_lidar(); }), driven),
                HasSubstr("of the LiDAR, read as poses of the camera"));
    EXPECT_THAT(find_reading(change_each(driven, [](const SE3& p) { return SE3{p.R, 1000 * p.t}; }), driven),
                HasSubstr("move 1000 times as far as the scans"));
  }
  const Trajectory driven = make_path(8, 0.3);
  const SE3 lidar_from_body{Eigen::Matrix3d{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, Eigen::Vector3d::Zero()};  // x right, y forward
  EXPECT_THAT(find_reading(change_each(driven, [&](const SE3& p) { return p * lidar_from_body; }), driven),
              HasSubstr("x right, y forward, z up"));
}

// The path is nearly straight, so that only the small turns show the mistake.
TEST(PoseReading, RecognizesQuaternionsWrittenWFirstByTurnsAlone) {
  const Trajectory driven = make_path(8, 0.02).in({so3_exp({0, 0, -0.7}), Eigen::Vector3d::Zero()});
  const auto read_w_last = [](const SE3& p) {
    const Eigen::Quaterniond q(p.R);
    return SE3{Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix(), p.t};
  };
  EXPECT_THAT(find_reading(change_each(driven, read_w_last), driven), HasSubstr("written w first"));
  EXPECT_EQ(find_reading(driven, driven), "");
}

TEST(PoseReading, ReportsNothingWithoutEnoughEvidence) {
  const auto inverted = [](const SE3& p) { return p.inverse(); };
  const Trajectory stationary = make_path(0, 0), driven = make_path(8, 0.1);
  EXPECT_EQ(find_reading(change_each(stationary, inverted), stationary), "") << "stationary";
  EXPECT_EQ(find_reading({}, driven), "") << "no poses";
  EXPECT_EQ(find_reading(make_path(8, -0.5), make_path(1, 0.5)), "") << "poses of another drive fit no reading";
  EXPECT_FALSE(find_better_reading(change_each(driven, inverted), camera_from_lidar(), {})) << "no scans";
}

}  // namespace
}  // namespace dvi::diagnostics
