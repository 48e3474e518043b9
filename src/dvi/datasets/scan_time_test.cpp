#include "dvi/datasets/scan_time.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi::datasets {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

constexpr float kToleranceS = 1e-6F;

ScanHeader header() { return {"0", 1'000'000'000, 950'000'000, 1'050'000'000, {}}; }

Eigen::Vector3f at(double azimuth_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180;
  return Eigen::Vector3d(10 * std::cos(a), 10 * std::sin(a), 1).cast<float>();
}

TEST(ScanTime, FollowsTheRotation) {
  const std::vector<Eigen::Vector3f> points = {at(179.999), at(90), at(0), at(-90)};
  EXPECT_THAT(times_by_azimuth(points, header(), {}), ElementsAre(FloatNear(-0.05F, 1e-5F), FloatNear(-0.025F, kToleranceS),
                                                                  FloatNear(0, kToleranceS), FloatNear(0.025F, kToleranceS)));
  EXPECT_THAT(times_by_azimuth({at(90), at(0)}, header(), {Turn::counterclockwise, 0}),
              ElementsAre(FloatNear(-0.025F, kToleranceS), FloatNear(-0.05F, kToleranceS)));
  EXPECT_THAT(times_by_azimuth(points, header(), {Turn::none, 0}), ElementsAre(0, 0, 0, 0));
}

TEST(ScanTime, RunsFromTheFirstToTheLastPoint) {
  // Only the front of a scan that begins at -62 degrees is left, +-70 degrees around -90, and its last point.
  const std::vector<Eigen::Vector3f> points = {at(-62), at(-61), at(-152), at(-20), at(-60), at(-61.8)};
  const auto when = [](double turned) { return FloatNear(static_cast<float>(-0.05 + 0.1 * turned / 359.8), kToleranceS); };
  EXPECT_THAT(times_in_order(points, header()), ElementsAre(when(0), when(-1), when(90), when(318), when(358), when(359.8)));
}

TEST(ScanTime, UsesTheTimesOfTheFile) {
  const media::PointCloud cloud{.points = {at(0), at(0)}, .intensity = {0, 0}, .t = {0.0F, 0.07F}, .ring = {1, 2}};
  const Scan scan = to_scan(cloud, header(), {});
  EXPECT_THAT(scan.time, ElementsAre(FloatNear(-0.05F, kToleranceS), FloatNear(0.02F, kToleranceS)));
  EXPECT_THAT(scan.ring, ElementsAre(1, 2));
}

}  // namespace
}  // namespace dvi::datasets
