#include "dvi/geometry/se3.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/geometry/box.h"
#include "dvi/geometry/skew.h"

namespace dvi {
namespace {

constexpr int kTrials = 500;

Eigen::Vector3d random_vector(Random& random, double scale) {
  return {random.uniform(-scale, scale), random.uniform(-scale, scale), random.uniform(-scale, scale)};
}

// The angles range from far below the threshold of the series up to just below pi.
Eigen::Vector3d random_rotation_vector(Random& random) {
  const double angle =
      random.below(2) == 0 ? std::pow(10.0, random.uniform(-12, 0)) : random.uniform(0, std::numbers::pi - 1e-6);
  return random_vector(random, 1).normalized() * angle;
}

SE3 random_pose(Random& random) { return {so3_exp(random_rotation_vector(random)), random_vector(random, 100)}; }

double distance(const SE3& a, const SE3& b) { return (a.R - b.R).norm() + (a.t - b.t).norm(); }

TEST(SE3, HasSkewMatricesOfTheCrossProduct) {
  Random random(11);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d v = random_vector(random, 3), x = random_vector(random, 3);
    EXPECT_EQ(skew(v) * x, v.cross(x));
    EXPECT_EQ(skew(v).transpose(), -skew(v));
  }
}

TEST(SE3, RecoversRotationVectors) {
  Random random(1);
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Vector3d w = random_rotation_vector(random);
    const Eigen::Matrix3d R = so3_exp(w);
    ASSERT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << w.transpose();
    ASSERT_NEAR(R.determinant(), 1, 1e-12);
    ASSERT_LT((so3_log(R) - w).norm(), 1e-12 + 1e-9 * w.norm()) << w.transpose();
  }
}

TEST(SE3, RotatesXToYByAQuarterTurnAboutZ) {
  const Eigen::Matrix3d R = so3_exp({0, 0, std::numbers::pi / 2});
  EXPECT_LT((R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(SE3, HasALogarithmOfLengthPiForHalfTurns) {
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 2, -2)}) {
    const Eigen::Vector3d axis = direction.normalized();
    const Eigen::Vector3d w = so3_log(Eigen::AngleAxisd(std::numbers::pi, axis).toRotationMatrix());
    EXPECT_NEAR(w.norm(), std::numbers::pi, 1e-9);
    EXPECT_NEAR(std::abs(w.normalized().dot(axis)), 1, 1e-9);
  }
}

TEST(SE3, RecoversTwists) {
  Random random(2);
  for (int i = 0; i < kTrials; ++i) {
    Vector6d twist;
    twist << random_vector(random, 50), random_rotation_vector(random);
    const Vector6d back = se3_log(se3_exp(twist));
    ASSERT_LT((back - twist).norm(), 1e-6) << twist.transpose();
  }
}

TEST(SE3, IsExactForSmallAngles) {
  for (const double angle : {1e-3, 1e-5, 1e-7, 1.1e-8, 1e-9}) {
    Vector6d twist;
    twist << 30, 20, 10, 0, 0, angle;
    const Eigen::Vector3d t = se3_exp(twist).t;
    // The oracle is the arc of a screw about z by series: sin(a)/a = 1 - a^2/6, (1 - cos(a))/a = a/2 - a^3/24.
    const double a2 = angle * angle, along = 1 - a2 / 6, across = angle / 2 * (1 - a2 / 12);
    EXPECT_NEAR(t.x(), 30 * along - 20 * across, 1e-10) << angle;
    EXPECT_NEAR(t.y(), 20 * along + 30 * across, 1e-10) << angle;
    EXPECT_NEAR(t.z(), 10, 1e-12) << angle;
  }
}

TEST(SE3, InverseAndProductAgreeWithPoints) {
  Random random(3);
  for (int i = 0; i < kTrials; ++i) {
    const SE3 a = random_pose(random), b = random_pose(random);
    const Eigen::Vector3d x = random_vector(random, 10);
    ASSERT_LT(((a * b) * x - a * (b * x)).norm(), 1e-10);
    ASSERT_LT((a.inverse() * (a * x) - x).norm(), 1e-10);
  }
}

TEST(SE3, InterpolatesBetweenItsEndsAndComposes) {
  Random random(4);
  for (int i = 0; i < kTrials; ++i) {
    const SE3 a = random_pose(random);
    Vector6d step;
    step << random_vector(random, 5), random_vector(random, 1);
    const SE3 b = a * se3_exp(step);
    ASSERT_LT(distance(interpolate(a, b, 0), a), 1e-9);
    ASSERT_LT(distance(interpolate(a, b, 1), b), 1e-9);
    const SE3 middle = interpolate(a, b, 0.5);
    ASSERT_LT(distance(interpolate(a, middle, 0.5), interpolate(a, b, 0.25)), 1e-9);
    ASSERT_LT(distance(interpolate(a, middle, 2), b), 1e-8);  // extrapolates along the screw
  }
}

TEST(SE3, RecoversRotationsPrintedWithFewDigits) {
  Random random(5);
  for (int i = 0; i < kTrials; ++i) {
    const Eigen::Matrix3d R = so3_exp(random_rotation_vector(random));
    const Eigen::Matrix3d printed = R.unaryExpr([](double x) { return std::round(x * 1e4) / 1e4; });
    const Eigen::Matrix3d back = nearest_rotation(printed);
    ASSERT_LT((back * back.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
    ASSERT_NEAR(back.determinant(), 1, 1e-13);
    ASSERT_LT((back - R).norm(), 3e-4);
  }
  EXPECT_NEAR(nearest_rotation(Eigen::Vector3d(1, 1, -1).asDiagonal()).determinant(), 1, 1e-13);
}

TEST(Box, ContainsPointsInsideItsRotatedSides) {
  const Box box{{so3_exp({0, 0, std::numbers::pi / 2}), {10, 0, 1}}, {4, 2, 1.5}};
  EXPECT_TRUE(box.contains({10, 1.9, 1}));  // its length is along y
  EXPECT_FALSE(box.contains({11.9, 0, 1}));
  EXPECT_FALSE(box.contains({10, 2.1, 1}));
  EXPECT_TRUE(box.contains({10, 2.1, 1}, 0.2));
  EXPECT_FALSE(box.contains({10, 1.9, 1}, -0.2));
}

TEST(Box, HasCornersOnItsSurface) {
  Random random(6);
  const Box box{random_pose(random), {4, 2, 1.5}};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : box.corners()) {
    EXPECT_TRUE(box.contains(corner, 1e-9));
    EXPECT_FALSE(box.contains(corner, -1e-9));
    mean += corner / 8;
  }
  EXPECT_LT((mean - box.frame_from_box.t).norm(), 1e-9);
}

}  // namespace
}  // namespace dvi
