#include "dvi/registration/confirm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::registration {
namespace {

using Eigen::Vector3d;

/// Posts 5 m high, each at a place of its own, before a wall of 80 m.
std::vector<Vector3d> posts(std::uint64_t seed, const Vector3d& moved = Vector3d::Zero()) {
  std::vector<Vector3d> out;
  Random random(seed);
  for (double x = -40; x < 40; x += 5)
    for (const double y : {-6.0, 6.0}) {
      const Vector3d at(x + random.uniform(0, 4), y + random.uniform(-1, 1), 0);
      for (double z = 0.3; z < 5; z += 0.1) out.push_back(moved + at + Vector3d(0, 0, z));
    }
  for (double x = -40; x < 40; x += 0.12)
    for (double z = 0.3; z < 5; z += 0.3) out.push_back(moved + Vector3d(x, 12, z));
  return out;
}

TEST(Confirm, APlaceConfirmsItself) {
  const Confirmation found = confirm(posts(1), posts(1));
  EXPECT_GT(found.confirmed, 15);
  EXPECT_GT(found.share(), 0.9);
}

TEST(Confirm, AMoveOfHalfAMeterIsSeen) {
  const Confirmation found = confirm(posts(1), posts(1, {0.5, 0, 0}));
  EXPECT_GT(found.moved, 15);
  EXPECT_EQ(found.confirmed, 0);
}

TEST(Confirm, AnotherStreetOfTheSameKindAgreesByChanceOnly) {
  for (std::uint64_t seed = 2; seed < 12; ++seed) EXPECT_LT(confirm(posts(1), posts(seed)).share(), 0.35) << seed;
}

TEST(Confirm, AWallAloneSaysNothing) {
  std::vector<Vector3d> wall;
  for (double x = -40; x < 40; x += 0.12)
    for (double z = 0.3; z < 5; z += 0.3) wall.emplace_back(x, 8, z);
  EXPECT_LE(confirm(wall, wall).all(), 2) << "its ends";
  EXPECT_EQ(confirm(wall, {}).all(), 0);
  EXPECT_EQ(confirm({}, wall).all(), 0);
}

}  // namespace
}  // namespace dvi::registration
