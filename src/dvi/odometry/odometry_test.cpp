#include "dvi/odometry/odometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/threads.h"
#include "dvi/odometry/sharpness.h"
#include "dvi/scan_match/local_map.h"
#include "dvi/scan_match/register_scan.h"
#include "dvi/testing/test_street.h"

namespace dvi::odometry {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LocalMap, DistinguishesPlanesLinesAndVolumes) {
  scan_match::LocalMap map(1);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    map.add({random.uniform(), random.uniform(), 0.3 + 0.01 * random.normal()});
    map.add({5.5 + 0.02 * random.normal(), 0.5 + 0.02 * random.normal(), random.uniform()});
    map.add({9 + random.uniform(), random.uniform(), random.uniform()});
  }
  const scan_match::Shape* plane = map.at({0.1, 0.9, 0.9}, 1);
  ASSERT_NE(plane, nullptr);
  EXPECT_EQ(plane->thin, 1);
  EXPECT_GT(std::abs(plane->axes(2, 0)), 0.999);
  EXPECT_NEAR(plane->variance[0], 1e-4, 3e-5);
  const scan_match::Shape* line = map.at({5.5, 0.5, 0.5}, 2);
  ASSERT_NE(line, nullptr);
  EXPECT_EQ(line->thin, 2);
  EXPECT_EQ(map.at({9.5, 0.5, 0.5}, 1), nullptr);
  EXPECT_EQ(map.at({-50, 0, 0}, 1), nullptr);
}

TEST(LocalMap, RemovesPoints) {
  scan_match::LocalMap map(1), other(1);
  Random random(2);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 60; ++i) points.push_back({random.uniform(), random.uniform(), 0.01 * random.normal() + 0.5});
  for (const Eigen::Vector3d& p : points) map.add(p);
  for (int i = 0; i < 30; ++i) map.add({0.5, 0.5, 0.9});
  for (int i = 0; i < 30; ++i) map.remove({0.5, 0.5, 0.9});
  for (const Eigen::Vector3d& p : points) other.add(p);
  ASSERT_NE(map.at({0.5, 0.5, 0.5}, 1), nullptr);
  EXPECT_LT((map.at({0.5, 0.5, 0.5}, 1)->mean - other.at({0.5, 0.5, 0.5}, 1)->mean).norm(), 1e-12);
  map.remove({99, 0, 0});  // not in the map
  EXPECT_EQ(map.size(), 1);
  map.keep_near({500, 0, 0}, 100);
  EXPECT_EQ(map.size(), 0);
}

/// The true pose at the middle of scan i relative to the first scan.
SE3 truth_from_start(const Trajectory& path, std::size_t i) {
  return path.at(0)->inverse() * *path.at(static_cast<std::int64_t>(i) * TestStreet::kScanPeriodNs);
}

TEST(RegisterScan, FindsAKnownMotion) {
  const TestStreet street;
  const Trajectory path = TestStreet::path(0);
  const Scan scan = street.scan(path, 0);
  const scan_match::Features features = scan_match::find_features(scan, scan_match::find_rings(scan), {});
  scan_match::LocalMaps scene{scan_match::LocalMap(0.5), scan_match::LocalMap(1.5), scan_match::LocalMap(0.8)};
  Vector6d away;
  away << 0.3, -0.2, 0.1, 0.01, -0.01, 0.03;
  scene.add(features, se3_exp(away), Vector6d::Zero());
  const scan_match::Registration found = scan_match::register_scan(features, {}, scene, {});
  EXPECT_LT((found.world_from_lidar.t - se3_exp(away).t).norm(), 0.01);
  EXPECT_LT(so3_log(found.world_from_lidar.R.transpose() * se3_exp(away).R).norm(), 5e-4);
  EXPECT_EQ(found.degenerate, 0);
}

TEST(Odometry, FollowsACurveFromAnUnknownSpeed) {
  const Trajectory path = TestStreet::path(11, 0.15, 2);
  const Odometry found = estimate_odometry(TestStreet().drive(path, 20), {});
  EXPECT_THAT(found.warnings, IsEmpty());
  ASSERT_EQ(found.world_from_lidar.poses().size(), 20);
  EXPECT_LT(worst_error(found.world_from_lidar, path), 0.05);  // on a path of 23 m
  for (std::size_t i = 1; i < 6; ++i) {
    const auto step = [&](const SE3& a, const SE3& b) { return (a.inverse() * b).t; };
    const auto& poses = found.world_from_lidar.poses();
    EXPECT_LT((step(poses[i - 1].world_from_body, poses[i].world_from_body) -
               step(truth_from_start(path, i - 1), truth_from_start(path, i)))
                  .norm(),
              0.03)
        << i;
  }
}

TEST(Odometry, IsStationaryWithTheCar) {
  const Trajectory path = TestStreet::path(0);
  const Odometry found = estimate_odometry(TestStreet().drive(path, 6), {});
  EXPECT_THAT(found.warnings, IsEmpty());
  EXPECT_LT(worst_error(found.world_from_lidar, path), 0.01);
}

TEST(Odometry, WarnsOfAnUnconstrainedDirectionInATunnel) {
  const Odometry found = estimate_odometry(TestStreet::tunnel().drive(TestStreet::path(10), 6), {});
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_THAT(found.warnings.back(), HasSubstr("do not constrain the pose"));
  EXPECT_EQ(found.scans[3].degenerate, 1);
}

TEST(Odometry, SkipsEmptyAndRepeatedScans) {
  const Trajectory path = TestStreet::path(8);
  Drive drive = TestStreet().drive(path, 10);
  const Lazy<Scan> scans = drive.scans;
  drive.scans = {10, 10, [scans](std::size_t i) { return i == 4 ? Scan{} : i == 7 ? *scans[6] : *scans[i]; }};
  const Odometry found = estimate_odometry(drive, {});
  EXPECT_EQ(found.scans[4].state, ScanFit::State::no_points);
  EXPECT_EQ(found.scans[7].state, ScanFit::State::duplicate);
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("too few points"), HasSubstr("repeat the scan before")));
  EXPECT_EQ(found.world_from_lidar.poses().size(), 8);
  EXPECT_LT(worst_error(found.world_from_lidar, path), 0.03);
  EXPECT_TRUE(found.world_from_lidar.at(drive.scan_headers[7].time_ns));
}

TEST(Odometry, WarnsOfScansThatDoNotFit) {
  const Trajectory path = TestStreet::path(5);
  Drive drive = TestStreet().drive(path, 12);
  TestStreet elsewhere;
  for (auto& box : elsewhere.boxes) box.translate(Eigen::Vector3d(7, 2.5, 0));
  elsewhere.boxes.resize(9);
  const Lazy<Scan> here = drive.scans, there = elsewhere.drive(TestStreet::path(5, 0.4), 12).scans;
  drive.scans = {12, 12, [here, there](std::size_t i) { return i < 6 ? *here[i] : *there[i]; }};
  for (std::size_t i = 6; i < 12; ++i) drive.scan_headers[i].time_ns += 60 * 1'000'000'000LL;
  const Odometry found = estimate_odometry(drive, {});
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_THAT(found.warnings.front(), HasSubstr("unreliable"));
}

TEST(Odometry, WarnsOfWrongAxes) {
  Drive drive = TestStreet().drive(TestStreet::path(5), 3);
  const Lazy<Scan> scans = drive.scans;
  drive.scans = {3, 3, [scans](std::size_t i) {
                   Scan scan = *scans[i];
                   for (auto& p : scan.points) p = {p.x(), -p.y(), -p.z()};  // z down
                   return scan;
                 }};
  EXPECT_THAT(estimate_odometry(drive, {}).warnings, testing::Contains(HasSubstr("z up")));
}

TEST(Odometry, AcceptsDrivesOfOneScanOrNone) {
  const Odometry one = estimate_odometry(TestStreet().drive(TestStreet::path(0), 1), {});
  EXPECT_THAT(one.warnings, ElementsAre(HasSubstr("only one scan")));
  EXPECT_TRUE(one.world_from_lidar.at(-50'000'000));
  EXPECT_TRUE(estimate_odometry({}, {}).world_from_lidar.empty());
}

TEST(Odometry, DoesNotDependOnTheNumberOfThreads) {
  Odometry found[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    found[threads - 1] = estimate_odometry(TestStreet().drive(TestStreet::path(8), 5), {});
  }
  for (std::size_t i = 0; i < 5; ++i) {
    const SE3 &a = found[0].world_from_lidar.poses()[i].world_from_body,
              &b = found[1].world_from_lidar.poses()[i].world_from_body;
    EXPECT_EQ(a.R, b.R);
    EXPECT_EQ(a.t, b.t);
  }
}

TEST(Sharpness, MeasuresErrorsOfPoses) {
  const Trajectory path = TestStreet::path(8);
  const Drive drive = TestStreet().drive(path, 12);
  const Sharpness exact = measure_sharpness(drive, path);
  EXPECT_GT(exact.ground_patches, 100);
  EXPECT_GT(exact.vertical_patches, 30);
  EXPECT_LT(exact.total_m(), 0.004);
  Random random(8);
  std::vector<StampedPose> off;
  for (const ScanHeader& header : drive.scan_headers) {
    off.push_back({header.time_ns, *path.at(header.time_ns)});
    off.back().world_from_body.t += 0.05 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  }
  const Sharpness shaken = measure_sharpness(drive, Trajectory(off));
  EXPECT_NEAR(shaken.ground_m, 0.05, 0.02);
  EXPECT_NEAR(shaken.vertical_m, 0.05, 0.02);
  EXPECT_FALSE(measure_sharpness(drive, Trajectory()).known());
}

}  // namespace
}  // namespace dvi::odometry
