#include "dvi/geometry/normal_equations.h"

#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "dvi/core/random.h"

namespace dvi {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

// Makes a chain of unknowns, each coupled to the next and weakly to zero. Entries with the same indices have several parts.
Entries chain(int unknowns, Random& random, bool upper_half) {
  Entries entries;
  for (int i = 0; i < unknowns; ++i) entries.emplace_back(i, i, 0.1);
  for (int i = 0; i + 1 < unknowns; ++i) {
    const double weight = random.uniform(1, 2);
    entries.emplace_back(i, i, weight);
    entries.emplace_back(i + 1, i + 1, weight);
    entries.emplace_back(i + 1, i, -weight);
    if (upper_half) entries.emplace_back(i, i + 1, -weight);
  }
  return entries;
}

TEST(NormalEquations, AreSolvedForAllColumns) {
  Random random(1);
  const Entries entries = chain(40, random, true);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(40, 40);
  for (const auto& entry : entries) dense(entry.row(), entry.col()) += entry.value();
  Eigen::MatrixXd right(40, 3);
  for (double& value : right.reshaped()) value = random.normal();
  EXPECT_LT((solve_normal_equations(entries, right) - dense.ldlt().solve(right)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(NormalEquations, NeedTheLowerHalfOnly) {
  Random first(2), second(2);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(20, -1, 1);
  EXPECT_EQ(solve_normal_equations(chain(20, first, true), right), solve_normal_equations(chain(20, second, false), right));
}

TEST(NormalEquations, AreRefusedIfSingular) {
  const Entries loose{{0, 0, 1.0}};  // the second unknown has no equation
  EXPECT_THROW(solve_normal_equations(loose, Eigen::VectorXd::Ones(2)), std::logic_error);
}

TEST(NormalEquations, MayBeEmpty) { EXPECT_EQ(solve_normal_equations({}, Eigen::MatrixXd(0, 4)).rows(), 0); }

}  // namespace
}  // namespace dvi
