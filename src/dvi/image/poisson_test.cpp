#include "dvi/image/poisson.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/SparseCholesky>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/image/region.h"

namespace dvi {
namespace {

/// Makes a system with Dirichlet conditions where the region ends within the image.
PoissonSystem random_system(const cv::Mat1b& mask, std::uint64_t seed, float vertical = 1) {
  Random random(seed);
  PoissonSystem system{Region(mask), {}, {}, vertical};
  for (const cv::Point p : system.region.pixels) {
    float neighbors = 0;
    for (const cv::Point d : {cv::Point(-1, 0), cv::Point(1, 0), cv::Point(0, -1), cv::Point(0, 1)})
      if (cv::Rect({}, mask.size()).contains(p + d)) neighbors += d.y == 0 ? 1 : vertical;
    system.diagonal.push_back(neighbors);
    cv::Vec3f right;
    for (int c = 0; c < 3; ++c) right[c] = static_cast<float>(random.uniform(-40, 40));
    system.right.push_back(right);
  }
  return system;
}

double error_to_direct(const PoissonSystem& system, const std::vector<cv::Vec3f>& x) {
  const Region& region = system.region;
  const int n = static_cast<int>(region.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, system.diagonal[i]);
    for (const cv::Point d : {cv::Point(1, 0), cv::Point(0, 1)}) {
      const cv::Point q = region.pixels[i] + d;
      if (!cv::Rect({}, region.index.size()).contains(q) || region.index(q) < 0) continue;
      const double beside = system.beside.empty() ? 1 : system.beside[i];
      const double weight = d.y == 0 ? beside : system.below.empty() ? system.vertical : system.below[i];
      entries.emplace_back(i, region.index(q), -weight);
      entries.emplace_back(region.index(q), i, -weight);
    }
  }
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> direct(a);
  double worst = 0;
  for (int c = 0; c < 3; ++c) {
    Eigen::VectorXd right(n);
    for (int i = 0; i < n; ++i) right[i] = system.right[i][c];
    const Eigen::VectorXd truth = direct.solve(right);
    for (int i = 0; i < n; ++i) worst = std::max(worst, std::abs(truth[i] - x[i][c]));
  }
  return worst;
}

cv::Mat1b shape(int which) {
  cv::Mat1b mask(160, 220, uchar{0});
  Random random(which);
  switch (which) {
    case 0:
      cv::ellipse(mask, {100, 80}, {80, 60}, 20, 0, 360, 255, cv::FILLED);
      break;
    case 1:
      mask(cv::Rect(0, 0, 90, 70)) = 255;
      mask(cv::Rect(210, 150, 10, 10)) = 255;
      break;
    case 2:
      for (uchar& v : mask) v = random.uniform() < 0.62 ? 255 : 0;  // a maze
      break;
    case 3:
      for (int i = 0; i < 160; i += 3) mask.row(i) = 255;  // lines
      break;
    default:
      mask = 255;
      mask(80, 110) = 0;
  }
  return mask;
}

TEST(Poisson, EqualsTheDirectSolution) {
  for (int which = 0; which < 5; ++which) {
    const PoissonSystem system = random_system(shape(which), which);
    std::vector<cv::Vec3f> x(system.region.size());
    const int iterations = solve_poisson(system, x);
    // One known pixel in the frame: random sources without balance lead to values in the thousands.
    EXPECT_LT(error_to_direct(system, x), which == 4 ? 2 : 0.05) << "shape " << which;
    EXPECT_LT(iterations, 50) << "shape " << which;
  }
}

TEST(Poisson, EqualsTheDirectSolutionWithLargerVerticalWeights) {
  for (int which = 0; which < 4; ++which) {
    const PoissonSystem system = random_system(shape(which), which, 0.1F);
    std::vector<cv::Vec3f> x(system.region.size());
    EXPECT_LT(solve_poisson(system, x), 100) << "shape " << which;
    EXPECT_LT(error_to_direct(system, x), 0.2) << "shape " << which;
  }
}

TEST(Poisson, EqualsTheDirectSolutionWithWeightsPerColumn) {
  for (int which = 0; which < 4; ++which) {
    PoissonSystem system = random_system(shape(which), which, 0.1F);
    Random random(which);
    for (std::size_t i = 0; i < system.region.size(); ++i) system.below.push_back(static_cast<float>(random.uniform(0.01, 1)));
    for (float& diagonal : system.diagonal) diagonal += 2;  // at least the sum of weights
    std::vector<cv::Vec3f> x(system.region.size());
    EXPECT_LT(solve_poisson(system, x), 100) << "shape " << which;
    EXPECT_LT(error_to_direct(system, x), 0.2) << "shape " << which;
  }
}

TEST(Poisson, EqualsTheDirectSolutionWithVerySmallWeights) {
  for (int which = 0; which < 4; ++which) {
    PoissonSystem system = random_system(shape(which), which);
    Random random(which);
    for (std::vector<float>* weights : {&system.beside, &system.below})
      for (std::size_t i = 0; i < system.region.size(); ++i) weights->push_back(random.below(8) == 0 ? 0.05F : 1);
    for (float& diagonal : system.diagonal) diagonal += 0.1F;
    std::vector<cv::Vec3f> x(system.region.size());
    EXPECT_LT(solve_poisson(system, x), 50) << "shape " << which;
    EXPECT_LT(error_to_direct(system, x), 0.1) << "shape " << which;
  }
}

TEST(Poisson, StopsImmediatelyAtTheSolution) {
  const PoissonSystem system = random_system(shape(0), 3);
  std::vector<cv::Vec3f> x(system.region.size());
  solve_poisson(system, x, 1e-3);
  EXPECT_EQ(solve_poisson(system, x), 0);
}

TEST(Poisson, SolvesEmptyAndSinglePixelRegions) {
  std::vector<cv::Vec3f> none;
  EXPECT_EQ(solve_poisson(random_system(cv::Mat1b(4, 4, uchar{0}), 1), none), 0);
  cv::Mat1b one(4, 4, uchar{0});
  one(1, 2) = 255;
  PoissonSystem system = random_system(one, 1);
  system.right[0] = {4, 8, 400};
  std::vector<cv::Vec3f> x(1);
  solve_poisson(system, x);
  EXPECT_EQ(x[0], cv::Vec3f(1, 2, 100));
}

}  // namespace
}  // namespace dvi
