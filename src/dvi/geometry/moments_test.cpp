#include "dvi/geometry/moments.h"

#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi {
namespace {

std::vector<Eigen::Vector3d> cloud(std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(random.uniform(-3, 1), random.uniform(0, 5), 0.1 * random.uniform(0, 1));
  return points;
}

Moments<double> moments_of(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& origin) {
  Moments<double> out;
  for (const Eigen::Vector3d& p : points) out.add(Eigen::Vector3d(p - origin));
  return out;
}

TEST(Moments, AreMeanAndCovariance) {
  const std::vector<Eigen::Vector3d> points = cloud(1);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / 50;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose() / 50;
  const Moments<double> moments = moments_of(points, {0, 0, 0});
  EXPECT_EQ(moments.count, 50);
  EXPECT_LT((moments.mean() - mean).norm(), 1e-12);
  EXPECT_LT((moments.covariance() - covariance).norm(), 1e-12);
}

TEST(Moments, OfOtherOriginsAreAdded) {
  const std::vector<Eigen::Vector3d> here = cloud(2), there = cloud(3);
  const Eigen::Vector3d origin(10, -4, 2);
  Moments<double> together = moments_of(here, {0, 0, 0});
  together.add(moments_of(there, origin), origin);
  std::vector<Eigen::Vector3d> all = here;
  all.insert(all.end(), there.begin(), there.end());
  const Moments<double> expected = moments_of(all, {0, 0, 0});
  EXPECT_EQ(together.count, 100);
  EXPECT_LT((together.mean() - expected.mean()).norm(), 1e-12);
  EXPECT_LT((together.covariance() - expected.covariance()).norm(), 1e-10);
}

TEST(Moments, WithoutRemovedPointsAreThoseOfTheRest) {
  const std::vector<Eigen::Vector3d> points = cloud(4);
  Moments<double> moments = moments_of(points, {0, 0, 0});
  const Moments<double> before = moments;
  for (const Eigen::Vector3d& p : cloud(5)) moments.add(p);
  for (const Eigen::Vector3d& p : cloud(5)) moments.remove(p);
  EXPECT_EQ(moments.count, before.count);
  EXPECT_LT((moments.covariance() - before.covariance()).norm(), 1e-12);
}

}  // namespace
}  // namespace dvi
