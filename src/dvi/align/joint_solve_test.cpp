#include "dvi/align/joint_solve.h"

#include <cmath>

#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::align {
namespace {

constexpr double kRotationRad = 2e-3, kMountingRad = 4e-3, kPairRad = 2e-4;

/// The model of a pair that measures the rotations of both views exactly: precisely their difference, less precisely their
/// mean.
PairModel make_exact_pair(std::size_t moving, std::size_t fixed, const Eigen::Vector3d& moving_truth,
                          const Eigen::Vector3d& fixed_truth) {
  constexpr double kInformation = 1e9, kCommon = 1e8;
  PairModel model{moving, fixed, {}, {}};
  Eigen::Matrix<double, 3, 6> apart, common;
  apart << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  common << 0.5 * Eigen::Matrix3d::Identity(), 0.5 * Eigen::Matrix3d::Identity();
  model.H = kInformation * apart.transpose() * apart + kCommon * common.transpose() * common;
  Vector6d truth;
  truth << moving_truth, fixed_truth;
  model.g = -model.H * truth;
  return model;
}

std::vector<Eigen::Vector3d> make_random_rotations(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3d> out;
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(kRotationRad * random.normal(), kRotationRad * random.normal(), 0);
  return out;
}

std::vector<PairModel> make_chain(const std::vector<Eigen::Vector3d>& truth) {
  std::vector<PairModel> models;
  for (const std::size_t apart : {1, 2, 4})
    for (std::size_t i = 0; i + apart < truth.size(); ++i) {
      models.push_back(make_exact_pair(i, i + apart, truth[i], truth[i + apart]));
      models.push_back(make_exact_pair(i + apart, i, truth[i + apart], truth[i]));
    }
  return models;
}

/// Returns the largest error of the rotation between consecutive views.
double max_step_error(const Corrections& found, const std::vector<Eigen::Vector3d>& truth) {
  double worst = 0;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i)
    worst = std::max(worst, (found.rotations[i + 1] - found.rotations[i] - truth[i + 1] + truth[i]).norm());
  return worst;
}

TEST(JointSolve, AnchorsFixTheCommonRotation) {
  auto truth = make_random_rotations(6, 2);
  for (Eigen::Vector3d& rotation : truth) rotation += Eigen::Vector3d(kMountingRad, -kMountingRad, 0);
  std::vector<PairModel> models = make_chain(truth);
  for (std::size_t i = 0; i < 6; ++i) models.push_back(make_exact_pair(i, 6 + i % 2, truth[i], Eigen::Vector3d::Zero()));
  const Corrections found = solve_jointly(models, Corrections(6), {kRotationRad, kMountingRad, kPairRad});
  ASSERT_EQ(found.rotations.size(), 6);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT((found.rotations[i] - truth[i]).norm(), 0.1 * kRotationRad) << i;
}

TEST(JointSolve, RecoversTheRotationsOfAllViews) {
  const auto truth = make_random_rotations(12, 1);
  const Corrections found = solve_jointly(make_chain(truth), Corrections(12), {kRotationRad, kMountingRad, kPairRad});
  EXPECT_LT(max_step_error(found, truth), 0.02 * kRotationRad);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_LT((found.rotations[i] - truth[i]).norm(), 0.1 * kRotationRad) << i;
}

TEST(JointSolve, FindsTheCommonRotationAsTheMounting) {
  auto truth = make_random_rotations(16, 2);
  const Eigen::Vector3d mounting(3e-3, -5e-3, 0);
  for (Eigen::Vector3d& rotation : truth) rotation += mounting;
  const Corrections found = solve_jointly(make_chain(truth), Corrections(16), {kRotationRad, kMountingRad, kPairRad});
  EXPECT_LT((found.mounting - mounting).norm(), 0.4 * mounting.norm());
  for (std::size_t i = 0; i < 16; ++i) EXPECT_LT((found.rotations[i] - truth[i]).norm(), 0.15 * mounting.norm()) << i;
}

TEST(JointSolve, HasNoCommonRotationIfDisabled) {
  auto truth = make_random_rotations(16, 2);
  for (Eigen::Vector3d& rotation : truth) rotation += Eigen::Vector3d(3e-3, -5e-3, 0);
  Corrections now(16);
  now.rotations[3] = {1e-3, 0, 0};
  const Corrections found = solve_jointly(
      make_chain(truth), now, {.rotation = kRotationRad, .mounting = kMountingRad, .pair = kPairRad, .common = false});
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& rotation : found.rotations) sum += rotation;
  EXPECT_LT(sum.norm(), 1e-9);
  EXPECT_LT(found.mounting.norm(), 1e-9);
}

TEST(JointSolve, IsRobustToOneWrongPair) {
  const auto truth = make_random_rotations(12, 3);
  std::vector<PairModel> models = make_chain(truth);
  const Eigen::Vector3d wrong = truth[5] + Eigen::Vector3d(0.02, 0, 0);  // a hundred times the expected error of a pair
  models[10] = make_exact_pair(5, 6, wrong, truth[6]);
  const Corrections found = solve_jointly(models, Corrections(12), {kRotationRad, kMountingRad, kPairRad});
  EXPECT_LT(max_step_error(found, truth), 0.1 * kRotationRad);
}

TEST(JointSolve, ViewsWithoutPairsStayAtTheMounting) {
  const auto truth = make_random_rotations(6, 4);
  const Corrections found = solve_jointly(make_chain(truth), Corrections(7), {kRotationRad, kMountingRad, kPairRad});
  EXPECT_LT((found.rotations[6] - found.mounting).norm(), 1e-12);
  const Corrections nothing = solve_jointly({}, Corrections(3), {kRotationRad, kMountingRad, kPairRad});
  for (const Eigen::Vector3d& rotation : nothing.rotations) EXPECT_EQ(rotation, Eigen::Vector3d::Zero());
}

/// The model of a pair that measures the rotations and positions of both views exactly.
PairModel make_exact_pose_pair(std::size_t moving, std::size_t fixed, const Vector6d& moving_truth,
                               const Vector6d& fixed_truth) {
  PairModel model{moving, fixed, {}, {}};
  Eigen::Matrix<double, 6, 12> apart, common;
  apart << Matrix6d::Identity(), -Matrix6d::Identity();
  common << 0.5 * Matrix6d::Identity(), 0.5 * Matrix6d::Identity();
  model.H = 1e9 * apart.transpose() * apart + 1e8 * common.transpose() * common;
  Eigen::VectorXd truth(12);
  truth << moving_truth, fixed_truth;
  model.g = -model.H * truth;
  return model;
}

TEST(JointSolve, RecoversPositionsToo) {
  constexpr double kPositionM = 0.01, kPairM = 1e-3;
  Random random(6);
  std::vector<Vector6d> truth(12);
  Vector6d sum = Vector6d::Zero();
  for (Vector6d& pose : truth) {
    for (int k = 0; k < 6; ++k) pose[k] = (k < 3 ? kRotationRad : kPositionM) * random.normal();
    sum += pose;
  }
  std::vector<PairModel> models;
  for (const std::size_t apart : {1, 2, 4})
    for (std::size_t i = 0; i + apart < truth.size(); ++i) {
      models.push_back(make_exact_pose_pair(i, i + apart, truth[i], truth[i + apart]));
      models.push_back(make_exact_pose_pair(i + apart, i, truth[i + apart], truth[i]));
    }
  for (const bool common : {true, false}) {
    const Corrections found = solve_jointly(models, Corrections(12),
                                            {.rotation = kRotationRad,
                                             .mounting = kMountingRad,
                                             .pair = kPairRad,
                                             .common = common,
                                             .position = kPositionM,
                                             .pair_m = kPairM});
    Vector6d found_sum = Vector6d::Zero();
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Vector6d without = truth[i] - (common ? 0.0 : 1.0 / 12) * sum;
      EXPECT_LT((found.rotations[i] - without.head<3>()).norm(), 0.1 * kRotationRad) << i;
      EXPECT_LT((found.positions[i] - without.tail<3>()).norm(), 0.1 * kPositionM) << i;
      found_sum.head<3>() += found.rotations[i], found_sum.tail<3>() += found.positions[i];
    }
    EXPECT_TRUE(common || found_sum.norm() < 1e-9);
  }
}

TEST(JointSolve, ContinuesFromThePosesOfTheModels) {
  const auto truth = make_random_rotations(12, 5);
  Corrections now(12);
  std::vector<Eigen::Vector3d> left = truth;
  for (std::size_t i = 0; i < 12; ++i) {
    now.rotations[i] = 0.7 * truth[i];
    left[i] -= now.rotations[i];
  }
  const Corrections at_once = solve_jointly(make_chain(truth), Corrections(12), {kRotationRad, kMountingRad, kPairRad});
  const Corrections in_steps = solve_jointly(make_chain(left), now, {kRotationRad, kMountingRad, kPairRad});
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_LT((at_once.rotations[i] - in_steps.rotations[i]).norm(), 0.02 * kRotationRad) << i;
}

}  // namespace
}  // namespace dvi::align
