#include "dvi/geometry/earth_place.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dvi {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180;
const EarthPlace kTruth{49.0125, 8.4375, 327};
const Eigen::Vector3d kAntenna(-0.8, 0.3, 1.1);

// A bend of 60 m at ten poses per second.
Trajectory bend(double meters) {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 60; ++i) {
    const double way = meters * i / 60, angle = way / 50;
    poses.push_back({i * 100'000'000LL, {so3_exp({0, 0, angle}), {50 * std::sin(angle), 50 * (1 - std::cos(angle)), 0}}});
  }
  return Trajectory(std::move(poses));
}

// Returns the fixes of an exact antenna; the lengths of a degree are computed by their series in multiples of the latitude.
std::vector<GeoFix> fixes_of(const Trajectory& path) {
  const double latitude = kTruth.latitude_deg * kRadPerDegree;
  const double north_degree = 111132.954 - 559.822 * std::cos(2 * latitude) + 1.175 * std::cos(4 * latitude);
  const double east_degree = 111412.84 * std::cos(latitude) - 93.5 * std::cos(3 * latitude) + 0.118 * std::cos(5 * latitude);
  std::vector<GeoFix> fixes;
  for (const StampedPose& pose : path.poses()) {
    const Eigen::Vector3d at = pose.world_from_body * kAntenna;
    const double s = std::sin(kTruth.heading_deg * kRadPerDegree), c = std::cos(kTruth.heading_deg * kRadPerDegree);
    const double east = s * at.x() - c * at.y(), north = c * at.x() + s * at.y();
    fixes.push_back(
        {pose.time_ns, kTruth.latitude_deg + north / north_degree, kTruth.longitude_deg + east / east_degree, kAntenna});
  }
  return fixes;
}

double meters_apart(const EarthPlace& a, const EarthPlace& b) {
  return 111'000 * std::hypot(a.latitude_deg - b.latitude_deg, std::cos(a.latitude_deg * kRadPerDegree) *
                                                                   std::remainder(a.longitude_deg - b.longitude_deg, 360));
}

TEST(FindPlace, AlignsAPathWithItsFixes) {
  const Trajectory path = bend(60);
  const auto found = find_place(path, fixes_of(path));
  ASSERT_TRUE(found);
  EXPECT_LT(meters_apart(found->place, kTruth), 0.01);
  EXPECT_NEAR(found->place.heading_deg, kTruth.heading_deg, 0.01);
  EXPECT_EQ(found->fixes, 61);
  EXPECT_LT(found->residual_m, 0.01);
}

TEST(FindPlace, IsRobustAgainstAFewOutliers) {
  const Trajectory path = bend(60);
  std::vector<GeoFix> fixes = fixes_of(path);
  std::mt19937 random(7);
  std::normal_distribution<double> meters(0, 0.05);
  for (GeoFix& fix : fixes) fix.latitude_deg += meters(random) / 111'000, fix.longitude_deg += meters(random) / 73'000;
  for (std::size_t i = 10; i < 20; ++i) fixes[i].latitude_deg += 25.0 / 111'000;
  const auto found = find_place(path, fixes);
  ASSERT_TRUE(found);
  EXPECT_LT(meters_apart(found->place, kTruth), 0.1);
  EXPECT_NEAR(std::remainder(found->place.heading_deg - kTruth.heading_deg, 360), 0, found->heading_bound_deg);
}

TEST(FindPlace, WorksAcrossTheDateLine) {
  const Trajectory path = bend(60);
  std::vector<GeoFix> fixes = fixes_of(path);
  const double east = 180 - kTruth.longitude_deg;
  for (GeoFix& fix : fixes) fix.longitude_deg = std::remainder(fix.longitude_deg + east, 360);
  const auto found = find_place(path, fixes);
  ASSERT_TRUE(found);
  EXPECT_LT(meters_apart(found->place, {kTruth.latitude_deg, 180, 0}), 0.01);
}

TEST(FindPlace, DoesNotGuessTheHeadingOfAShortPath) {
  const Trajectory path = bend(1);
  EXPECT_FALSE(find_place(path, fixes_of(path)));
  EXPECT_FALSE(find_place(bend(60), {}));
  std::vector<GeoFix> later = fixes_of(bend(60));
  for (GeoFix& fix : later) fix.time_ns += 3'600'000'000'000;
  EXPECT_FALSE(find_place(bend(60), later));
}

}  // namespace
}  // namespace dvi
