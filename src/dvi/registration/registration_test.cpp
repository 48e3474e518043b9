#include "dvi/registration/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "dvi/core/threads.h"
#include "dvi/geometry/angles.h"
#include "dvi/synth/scene.h"

namespace dvi::registration {
namespace {

struct Recorded {
  Drive drive;
  Trajectory truth;  // in the street's world
};

Recorded record(int seed, int day, int beams = 32, bool truck = false) {
  synth::SynthOptions options;
  options.seed = seed;
  options.day = day;
  options.frames = 14;
  options.width = 64;
  options.height = 36;
  options.beams = beams;
  options.columns = 600;
  options.truck = truck;
  const Drive lazy = synth::drive_of(std::make_shared<const synth::Scene>(options));
  Recorded out{lazy, lazy.poses};
  out.drive.masks = {};
  return out;
}

/// The drive in the opposite direction: played backwards by a car that is rotated by half a turn.
Recorded reverse(const Recorded& there) {
  const SE3 about{so3_exp({0, 0, M_PI}), Eigen::Vector3d::Zero()};
  const std::int64_t first = there.drive.scan_headers.front().time_ns, last = there.drive.scan_headers.back().time_ns;
  Recorded out = there;
  std::vector<StampedPose> poses = there.truth.poses();
  for (StampedPose& p : poses) p = {first + last - p.time_ns, p.world_from_body * about.inverse()};
  out.truth = Trajectory(poses);
  for (Frame& frame : out.drive.frames) frame.labels.clear();
  out.drive.scans = Lazy<Scan>(there.drive.scans.size(), [scans = there.drive.scans, about](std::size_t i) {
    Scan scan = *scans[scans.size() - 1 - i];
    for (Eigen::Vector3f& p : scan.points) p = (about * p.cast<double>()).cast<float>();
    for (float& t : scan.time) t = -t;
    return scan;
  });
  return out;
}

/// The drive with another mounting of the sensor.
Recorded remount(const Recorded& drive, const SE3& other_from_lidar) {
  Recorded out = drive;
  std::vector<StampedPose> poses = drive.truth.poses();
  for (StampedPose& p : poses) p.world_from_body = p.world_from_body * other_from_lidar.inverse();
  out.truth = Trajectory(poses);
  for (Frame& frame : out.drive.frames) frame.labels.clear();
  out.drive.scans = Lazy<Scan>(drive.drive.scans.size(), [scans = drive.drive.scans, other_from_lidar](std::size_t i) {
    Scan scan = *scans[i];
    for (Eigen::Vector3f& p : scan.points) p = (other_from_lidar * p.cast<double>()).cast<float>();
    return scan;
  });
  return out;
}

/// The trajectory in a world of its own.
Trajectory to_own_world(const Recorded& drive) {
  const SE3 other{so3_exp({0, 0, 2.2}), {-310, 95, 12}};
  return drive.truth.in(other * drive.truth.poses().front().world_from_body.inverse());
}

Placement place(const Recorded& target, const Recorded& source) {
  const Registered found =
      register_drives({&target.drive, target.truth, true, true}, {{&source.drive, to_own_world(source), false}}, {});
  return found.sources.front();
}

void expect_near_truth(const Placement& found, const Recorded& source) {
  ASSERT_TRUE(found.found()) << found.figures.landmark_inliers << " of " << found.figures.landmarks;
  EXPECT_GT(found.figures.overlap, 0.8);
  for (const StampedPose& p : found.world_from_lidar.poses()) {
    const SE3 off = source.truth.at(p.time_ns)->inverse() * p.world_from_body;
    EXPECT_LT(off.t.norm(), 0.03);
    EXPECT_LT(to_degrees(so3_log(off.R).norm()), 0.05);
    EXPECT_LT(off.t.norm(), found.figures.bound_m);
    EXPECT_LT(to_degrees(so3_log(off.R).norm()), found.figures.bound_deg);
  }
}

TEST(Registration, PlacesADriveOfAnotherDayWithoutAGuess) {
  const Recorded target = record(1, 1, 32, true), source = record(1, 2);
  const Placement found = place(target, source);
  expect_near_truth(found, source);
  EXPECT_LT(found.figures.second_best_ratio, 0.5);
}

TEST(Registration, PlacesADriveInTheOppositeDirectionWithAnotherSensor) {
  const Recorded target = record(2, 1);
  const SE3 mounting{so3_exp({0.03, -0.05, 0.2}), {0.5, 0.1, -0.6}};
  const Recorded source = remount(reverse(record(2, 2, 24)), mounting);
  expect_near_truth(place(target, source), source);
}

TEST(Registration, ASimilarStreetIsRejected) {
  const Recorded target = record(3, 1);
  for (const int seed : {4, 5}) EXPECT_FALSE(place(target, record(seed, 2)).found()) << seed;
}

TEST(Registration, GivenPosesAreTheInitialGuess) {
  const Recorded target = record(1, 1), source = record(1, 2);
  const Trajectory given = source.truth.in({so3_exp({0, 0, 0.02}), {1.5, -1, 0.3}});
  const Registered found = register_drives({&target.drive, target.truth, true, true}, {{&source.drive, given, true}}, {});
  expect_near_truth(found.sources.front(), source);
}

TEST(Registration, TheResultDoesNotDependOnTheNumberOfThreads) {
  const Recorded target = record(1, 1), source = record(1, 2);
  const Placement one = [&] {
    const ThreadLimit limit(1);
    return place(target, source);
  }();
  const Placement many = place(target, source);
  ASSERT_EQ(one.world_from_lidar.poses().size(), many.world_from_lidar.poses().size());
  for (std::size_t i = 0; i < one.world_from_lidar.poses().size(); ++i) {
    EXPECT_EQ(one.world_from_lidar.poses()[i].world_from_body.t, many.world_from_lidar.poses()[i].world_from_body.t);
    EXPECT_EQ(one.world_from_lidar.poses()[i].world_from_body.R, many.world_from_lidar.poses()[i].world_from_body.R);
  }
}

TEST(Registration, ADriveWithoutScansIsNotFound) {
  const Recorded target = record(1, 1);
  Recorded source = record(1, 2);
  source.drive.scan_headers.clear();
  EXPECT_FALSE(place(target, source).found());
}

}  // namespace
}  // namespace dvi::registration
