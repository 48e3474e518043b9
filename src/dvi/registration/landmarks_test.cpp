#include "dvi/registration/landmarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::registration {
namespace {

using Eigen::Vector3d;

/// Posts 5 m high at random positions in front of a wall of 80 m, all moved by `offset`.
std::vector<Vector3d> make_posts(std::uint64_t seed, const Vector3d& offset = Vector3d::Zero()) {
  std::vector<Vector3d> out;
  Random random(seed);
  for (double x = -40; x < 40; x += 5)
    for (const double y : {-6.0, 6.0}) {
      const Vector3d at(x + random.uniform(0, 4), y + random.uniform(-1, 1), 0);
      for (double z = 0.3; z < 5; z += 0.1) out.push_back(offset + at + Vector3d(0, 0, z));
    }
  for (double x = -40; x < 40; x += 0.12)
    for (double z = 0.3; z < 5; z += 0.3) out.push_back(offset + Vector3d(x, 12, z));
  return out;
}

TEST(Landmarks, TheSamePlaceAgrees) {
  const LandmarkVotes found = check_landmarks(make_posts(1), make_posts(1));
  EXPECT_GT(found.inliers, 15);
  EXPECT_GT(found.inlier_ratio(), 0.9);
}

TEST(Landmarks, AnOffsetOfHalfAMeterIsDetected) {
  const LandmarkVotes found = check_landmarks(make_posts(1), make_posts(1, {0.5, 0, 0}));
  EXPECT_GT(found.outliers, 15);
  EXPECT_EQ(found.inliers, 0);
}

TEST(Landmarks, ASimilarStreetAgreesByChanceOnly) {
  for (std::uint64_t seed = 2; seed < 12; ++seed)
    EXPECT_LT(check_landmarks(make_posts(1), make_posts(seed)).inlier_ratio(), 0.35) << seed;
}

TEST(Landmarks, AWallHasNoLandmarks) {
  std::vector<Vector3d> wall;
  for (double x = -40; x < 40; x += 0.12)
    for (double z = 0.3; z < 5; z += 0.3) wall.emplace_back(x, 8, z);
  EXPECT_LE(check_landmarks(wall, wall).total(), 2) << "the ends of the wall";
  EXPECT_EQ(check_landmarks(wall, {}).total(), 0);
  EXPECT_EQ(check_landmarks({}, wall).total(), 0);
}

}  // namespace
}  // namespace dvi::registration
