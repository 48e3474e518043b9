#include "dvi/scan_match/pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::scan_match {
namespace {

Vector6d random_twist(Random& random, double meters, double radians) {
  Vector6d out;
  for (int k = 0; k < 6; ++k) out[k] = (k < 3 ? meters : radians) * random.normal();
  return out;
}

Matrix6d information(double meters, double radians) {
  Vector6d out;
  out << Eigen::Vector3d::Constant(1 / (meters * meters)), Eigen::Vector3d::Constant(1 / (radians * radians));
  return out.asDiagonal();
}

/// Returns poses for two rounds on a circle of 100 m in steps of 1 m.
std::vector<SE3> two_rounds() {
  std::vector<SE3> poses(201);
  Vector6d step = Vector6d::Zero();
  step[0] = 1;
  step[5] = 2 * 3.14159265358979 / 100;
  poses[0].t = {4, -2, 1};
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i] = poses[i - 1] * se3_exp(step);
  return poses;
}

std::vector<PoseEdge> chain(const std::vector<SE3>& poses) {
  std::vector<PoseEdge> edges;
  for (std::size_t i = 1; i < poses.size(); ++i)
    edges.push_back({i - 1, i, poses[i - 1].inverse() * poses[i], information(0.01, 0.001), false});
  return edges;
}

PoseEdge loop(const std::vector<SE3>& truth, std::size_t a, std::size_t b) {
  return {a, b, truth[a].inverse() * truth[b], information(0.02, 0.001), true};
}

/// Simulates odometry: each step has the same small error.
std::vector<SE3> drifted(const std::vector<SE3>& truth) {
  std::vector<SE3> out{truth[0]};
  Vector6d drift;
  drift << 0.01, 0.002, 0.01, 1e-4, -1e-4, 6e-4;
  for (std::size_t i = 1; i < truth.size(); ++i)
    out.push_back(out.back() * (truth[i - 1].inverse() * truth[i]) * se3_exp(drift));
  return out;
}

double worst(const std::vector<SE3>& poses, const std::vector<SE3>& truth) {
  double out = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) out = std::max(out, (poses[i].t - truth[i].t).norm());
  return out;
}

TEST(PoseGraph, KeepsConsistentPoses) {
  const std::vector<SE3> truth = two_rounds();
  std::vector<SE3> poses = truth;
  std::vector<PoseEdge> edges = chain(truth);
  edges.push_back(loop(truth, 3, 103));
  EXPECT_THAT(solve_pose_graph(poses, edges), testing::Each(testing::DoubleNear(1, 1e-9)));
  EXPECT_LT(worst(poses, truth), 1e-9);
}

TEST(PoseGraph, FindsExactPosesFromNearbyOnes) {
  const std::vector<SE3> truth = two_rounds();
  std::vector<SE3> poses = truth;
  Random random(3);
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i] = poses[i] * se3_exp(random_twist(random, 0.5, 0.1));
  std::vector<PoseEdge> edges = chain(truth);
  edges.push_back(loop(truth, 103, 3));  // in either direction
  solve_pose_graph(poses, edges);
  EXPECT_LT(worst(poses, truth), 1e-6);
}

TEST(PoseGraph, RemovesDriftByLoopsAndKeepsTheFirstPose) {
  const std::vector<SE3> truth = two_rounds(), odometry = drifted(truth);
  std::vector<SE3> poses = odometry;
  std::vector<PoseEdge> edges = chain(odometry);
  for (std::size_t i = 0; i <= 100; i += 10) edges.push_back(loop(truth, i, i + 100));
  const std::vector<double> weights = solve_pose_graph(poses, edges);
  EXPECT_EQ(poses[0].R, truth[0].R);
  EXPECT_EQ(poses[0].t, truth[0].t);
  EXPECT_GT(*std::min_element(weights.begin(), weights.end()), 0.5);
  EXPECT_GT(worst(odometry, truth), 3);
  EXPECT_LT(worst(poses, truth), 0.5);
  for (std::size_t i = 0; i <= 100; ++i)  // the two rounds coincide
    EXPECT_LT((truth[i].inverse() * truth[i + 100] * (poses[i].inverse() * poses[i + 100]).inverse()).t.norm(), 0.05) << i;
}

TEST(PoseGraph, IgnoresALoopThatContradictsTheOthers) {
  const std::vector<SE3> truth = two_rounds(), odometry = drifted(truth);
  std::vector<PoseEdge> edges = chain(odometry);
  for (std::size_t i = 0; i <= 100; i += 10) edges.push_back(loop(truth, i, i + 100));
  std::vector<SE3> right = odometry, poses = odometry;
  solve_pose_graph(right, edges);
  edges.push_back(loop(truth, 45, 145));
  edges.back().a_from_b.t += Eigen::Vector3d(3, -2, 0);
  EXPECT_LT(solve_pose_graph(poses, edges).back(), 0.01);
  EXPECT_LT(worst(poses, right), 0.02);
}

TEST(PoseGraph, IsIndependentOfTheWorld) {
  const std::vector<SE3> truth = two_rounds(), odometry = drifted(truth);
  std::vector<PoseEdge> edges = chain(odometry);
  edges.push_back(loop(truth, 0, 200));
  Random random(5);
  const SE3 other = se3_exp(random_twist(random, 30, 0.7));
  std::vector<SE3> here = odometry, there = odometry;
  for (SE3& pose : there) pose = other * pose;
  solve_pose_graph(here, edges);
  solve_pose_graph(there, edges);
  for (SE3& pose : here) pose = other * pose;
  EXPECT_LT(worst(here, there), 1e-5);
}

TEST(PoseGraph, AcceptsNoPoseAndOnePose) {
  std::vector<SE3> none, one(1);
  EXPECT_THAT(solve_pose_graph(none, {}), testing::IsEmpty());
  EXPECT_THAT(solve_pose_graph(one, {}), testing::IsEmpty());
  std::vector<SE3> apart(3);
  EXPECT_THROW(solve_pose_graph(apart, {{0, 1, {}, information(1, 1), false}}), std::logic_error);
}

TEST(PoseGraph, HasACovarianceThatGrowsAlongAChainAndHalvesWithASecondMeasurement) {
  std::vector<SE3> poses(5);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].t = {2.0 * static_cast<double>(i), 0, 0};
  std::vector<PoseEdge> edges = chain(poses);
  const auto variance = [&](std::size_t a, std::size_t b) {
    return compute_relative_covariance({poses, edges, std::vector<double>(edges.size(), 1.0)}, a, b).diagonal().eval();
  };
  EXPECT_NEAR(variance(0, 1)[0], 1e-4, 1e-9);
  EXPECT_NEAR(variance(0, 4)[0], 4e-4, 1e-9) << "four steps of 1 cm";
  EXPECT_NEAR(variance(1, 3)[0], 2e-4, 1e-9) << "independent of the outer edges";
  // A rotation by 1 mrad shifts points that are 2, 4 and 6 m ahead.
  EXPECT_NEAR(variance(0, 4)[1], 4e-4 + 1e-6 * (4 + 16 + 36), 1e-8);
  EXPECT_NEAR(variance(0, 4)[5], 4e-6, 1e-11);
  edges.push_back(edges[1]);
  EXPECT_NEAR(variance(1, 2)[0], 0.5e-4, 1e-9);
}

}  // namespace
}  // namespace dvi::scan_match
