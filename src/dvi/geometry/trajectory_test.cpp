#include "dvi/geometry/trajectory.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dvi {
namespace {

constexpr std::int64_t kStepNs = 100'000'000;  // 10 Hz

// A steady turn of 1.2 m and 0.02 rad per step.
SE3 turn(double steps) {
  Vector6d twist;
  twist << 1.2 * steps, 0, 0, 0, 0, 0.02 * steps;
  return se3_exp(twist);
}

Trajectory turning(int first, int last) {
  std::vector<StampedPose> poses;
  for (int i = first; i <= last; ++i) poses.push_back({i * kStepNs, turn(i)});
  return Trajectory(poses);
}

void expect_near(const std::optional<SE3>& pose, const SE3& wanted, double tolerance = 1e-9) {
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((pose->t - wanted.t).norm() + (pose->R - wanted.R).norm(), tolerance);
}

TEST(Trajectory, EmptyHasNoPoses) {
  EXPECT_TRUE(Trajectory().empty());
  EXPECT_FALSE(Trajectory().at(0).has_value());
}

TEST(Trajectory, HasAPoseOnlyAtTheTimeOfASingleOne) {
  const Trajectory one({{kStepNs, turn(3)}});
  expect_near(one.at(kStepNs), turn(3));
  EXPECT_FALSE(one.at(kStepNs + 1).has_value());
}

TEST(Trajectory, InterpolatesSteadyMotionExactly) {
  const Trajectory t = turning(0, 20);
  for (double at = 0; at <= 20; at += 0.37) expect_near(t.at(std::llround(at * kStepNs)), turn(at), 1e-7);
  for (int i = 0; i <= 20; ++i) expect_near(t.at(i * kStepNs), turn(i), 1e-15);
}

TEST(Trajectory, SortsPosesAndKeepsTheFirstOfEqualTimes) {
  const Trajectory t({{2 * kStepNs, turn(2)}, {0, turn(0)}, {kStepNs, turn(1)}, {kStepNs, turn(7)}});
  ASSERT_EQ(t.poses().size(), 3U);
  EXPECT_EQ(t.poses()[0].time_ns, 0);
  expect_near(t.at(kStepNs), turn(1));
}

TEST(Trajectory, ExtrapolatesBeyondTheEnds) {
  const Trajectory t = turning(0, 5);
  expect_near(t.at(7 * kStepNs), turn(7));
  expect_near(t.at(-2 * kStepNs), turn(-2));
  EXPECT_FALSE(t.at(7 * kStepNs + 1).has_value());
  EXPECT_FALSE(t.at(-2 * kStepNs - 1).has_value());
}

TEST(Trajectory, InterpolatesAcrossShortGapsOnly) {
  std::vector<StampedPose> poses = turning(0, 5).poses();
  for (int i = 15; i <= 20; ++i) poses.push_back({i * kStepNs, turn(i)});  // exactly max_gap apart
  Trajectory t(poses);
  expect_near(t.at(10 * kStepNs), turn(10));
  t.max_gap = 10 * kStepNs - 1;
  EXPECT_FALSE(t.at(10 * kStepNs).has_value());
  expect_near(t.at(5 * kStepNs), turn(5));
  expect_near(t.at(15 * kStepNs), turn(15));
}

TEST(Trajectory, IsTheSameMotionInAnotherWorld) {
  const SE3 other_from_world{so3_exp({0.1, -0.2, 2}), {5, 6, 7}};
  const Trajectory t = turning(0, 5).in(other_from_world);
  expect_near(t.at(250'000'000), other_from_world * turn(2.5));
}

// Nanoseconds since 1970 exceed the precision of a double.
TEST(Trajectory, KeepsNanosecondsSince1970) {
  const std::int64_t since_1970 = 1'557'540'003'123'456'789;
  const Trajectory t({{since_1970, turn(0)}, {since_1970 + 1000, turn(1)}});
  expect_near(t.at(since_1970 + 250), turn(0.25));
}

}  // namespace
}  // namespace dvi
