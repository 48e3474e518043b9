#include "dvi/objects/occluded_returns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dvi::objects {
namespace {

constexpr std::int64_t kTenth = 100'000'000;
constexpr double kSpeed = 8;  // meters per second to the left, of a panel 15 m ahead that is 2 m wide
constexpr int kHiddenFrom = 4;

double center(int scan) { return 0.1 * kSpeed * (scan - kHiddenFrom); }

// The surface in direction (1, y, z): the post, from one scan on; the panel; or the wall behind.
double range_along_x(double y, double z, int scan) {
  if (scan >= kHiddenFrom && std::abs(5 * y - 0.2) < 0.15) return 5;
  if (std::abs(15 * y - center(scan)) < 1 && std::abs(15 * z) < 0.8) return 15;
  return 40;
}

// A stationary sensor that looks ahead. Each scan takes no time.
Drive drive_before_a_panel(int scans) {
  Drive drive;
  std::vector<StampedPose> poses;
  for (int i = 0; i < scans; ++i) {
    ScanHeader header;
    header.time_ns = header.start_ns = header.end_ns = i * kTenth;
    drive.scan_headers.push_back(header);
    poses.push_back({i * kTenth, SE3{}});
  }
  drive.poses = Trajectory(poses);
  drive.scans = Lazy<Scan>(drive.scan_headers.size(), [](std::size_t i) {
    Scan scan;
    for (int row = -12; row <= 12; ++row)
      for (int column = -150; column <= 150; ++column) {
        const double degree = std::numbers::pi / 180, y = std::tan(0.2 * column * degree), z = std::tan(0.4 * row * degree);
        const double x = range_along_x(y, z, static_cast<int>(i));
        scan.points.emplace_back(static_cast<float>(x), static_cast<float>(x * y), static_cast<float>(x * z));
        scan.time.push_back(0);
      }
    scan.intensity.resize(scan.points.size());
    return scan;
  });
  return drive;
}

// The panel's returns of each scan.
Track track_of_panel(const Drive& drive) {
  Track track;
  for (std::size_t i = 0; i < drive.scan_headers.size(); ++i) {
    Cluster cluster;
    cluster.scan = i;
    for (const Eigen::Vector3f& point : drive.scans[i]->points) {
      if (std::abs(point.x() - 15) > 0.1F) continue;
      cluster.returns.push_back({point.cast<double>(), drive.scan_headers[i].time_ns, -1, 0.1});
    }
    measure(cluster);
    cluster.center = {15, center(static_cast<int>(i))};
    track.observations.push_back(cluster);
  }
  return track;
}

// Meters to the left of the panel's middle at which there are returns, in tenths.
std::vector<int> offsets(const Cluster& cluster) {
  std::vector<int> out;
  for (const ClusterReturn& r : cluster.returns)
    out.push_back(static_cast<int>(std::lround(10 * (r.point.y() - center(static_cast<int>(cluster.scan))))));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

TEST(OccludedReturns, AreAddedBehindANearerSurface) {
  const Drive drive = drive_before_a_panel(6);
  const ground::ScanGround ground(drive, drive.poses);
  const MovingReturns returns(drive, {drive.poses}, ground);
  const Track before = track_of_panel(drive);
  const Track after = add_occluded_returns({before}, returns).front();
  ASSERT_EQ(after.observations.size(), before.observations.size());
  const std::vector<int> hidden = offsets(before.observations[kHiddenFrom]), found = offsets(after.observations[kHiddenFrom]);
  EXPECT_LT(hidden.size(), 17U) << "the post hides no part of the panel";
  for (int tenth = -9; tenth <= 9; ++tenth) EXPECT_TRUE(std::binary_search(found.begin(), found.end(), tenth)) << tenth;
  EXPECT_GE(found.front(), -11);
  EXPECT_LE(found.back(), 11);
}

TEST(OccludedReturns, AreNotAddedWhereTheScanObservesTheObject) {
  const Drive drive = drive_before_a_panel(kHiddenFrom);
  const ground::ScanGround ground(drive, drive.poses);
  const MovingReturns returns(drive, {drive.poses}, ground);
  const Track before = track_of_panel(drive);
  const Track after = add_occluded_returns({before}, returns).front();
  for (std::size_t i = 0; i < before.observations.size(); ++i)
    EXPECT_EQ(after.observations[i].returns.size(), before.observations[i].returns.size()) << i;
}

}  // namespace
}  // namespace dvi::objects
