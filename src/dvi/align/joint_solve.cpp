#include "dvi/align/joint_solve.h"

#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "dvi/geometry/normal_equations.h"

namespace dvi::align {
namespace {

constexpr int kRounds = 5;      // of weighing pairs by how well they agree with all others
constexpr double kCommon = 10;  // times: the error of a pair about the rotation that both views share, to that between them
constexpr int kMounting = 0, kViews = 3;  // places of the unknowns

double information(double expected) { return 1 / (expected * expected); }

// Normal equations of the unknowns' change: mounting, then rotation of each view.
class Normal {
 public:
  explicit Normal(std::size_t views) : right_(Eigen::VectorXd::Zero(kViews + 3 * static_cast<int>(views))) {}

  // The upper half of the matrix is left out.
  void add(int row, int col, double value) {
    if (row >= col) entries_.emplace_back(row, col, value);
  }
  void add_right(int row, double value) { right_[row] += value; }
  // information * (value + change of an unknown)^2
  void add_prior(int at, double value, double information) {
    add(at, at, information);
    right_[at] -= information * value;
  }
  Eigen::VectorXd solve() const { return solve_normal_equations(entries_, right_); }
  // The change after which the rotations of all views, whose sum is `sum` now, add up to none. By Lagrange multipliers.
  Eigen::VectorXd solve_without_common(const Eigen::Vector3d& sum) const {
    const Eigen::Index views = (right_.size() - kViews) / 3;
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(right_.size(), 4);
    columns.col(0) = right_;
    columns.bottomRightCorner(3 * views, 3) = Eigen::Matrix3d::Identity().replicate(views, 1);
    const Eigen::MatrixXd solved = solve_normal_equations(entries_, columns);
    const Eigen::MatrixXd sums = columns.rightCols<3>().transpose() * solved;
    const Eigen::Vector3d multipliers = sums.rightCols<3>().ldlt().solve(sums.col(0) + sum);
    return solved.col(0) - solved.rightCols<3>() * multipliers;
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

void add_priors(Normal& normal, const Corrections& now, const Expected& expected) {
  for (int k = 0; k < 3; ++k) normal.add_prior(kMounting + k, now.mounting[k], information(expected.mounting));
  const double rotation = information(expected.rotation);
  for (std::size_t i = 0; i < now.rotations.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int at = kViews + 3 * static_cast<int>(i) + k;
      const double apart = now.rotations[i][k] - now.mounting[k];
      normal.add_prior(at, apart, rotation);
      normal.add_prior(kMounting + k, -apart, rotation);
      normal.add(at, kMounting + k, -rotation);
    }
}

std::array<int, 6> places(const PairModel& model) {
  const int moving = kViews + 3 * static_cast<int>(model.moving), fixed = kViews + 3 * static_cast<int>(model.fixed);
  return {moving, moving + 1, moving + 2, fixed, fixed + 1, fixed + 2};
}

// An anchor has none.
std::size_t unknowns(const PairModel& model, std::size_t views) { return model.fixed < views ? 6 : 3; }

// What a pair misleads about: the rotation between its views, and one that both have in common. The error that explains a
// gradient best, if its square costs `info`; the common part much less: it shows only in how surfaces come nearer from one view
// to the other, and there their shape has a say.
Matrix6d error_by_gradient(const PairModel& model, double info) {
  Matrix6d effect = Matrix6d::Zero();
  effect.topRows<3>() << Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity();
  effect.bottomRightCorner<3, 3>().setIdentity();
  Matrix6d inner = effect.transpose() * model.H * effect;
  inner.diagonal().head<3>().array() += info;
  inner.diagonal().tail<3>().array() += info / (kCommon * kCommon);
  return -effect * inner.ldlt().solve(effect.transpose());
}

// The pair's cost when its error is whatever makes it least.
void add_pair(Normal& normal, const PairModel& model, std::size_t views, double info) {
  const Matrix6d rest = Matrix6d::Identity() + model.H * error_by_gradient(model, info);
  const Matrix6d H = rest * model.H;
  const Vector6d g = rest * model.g;
  const auto at = places(model);
  for (std::size_t i = 0; i < unknowns(model, views); ++i) {
    const int row = static_cast<int>(i);
    normal.add_right(at[i], -g[row]);
    for (std::size_t j = 0; j < unknowns(model, views); ++j) normal.add(at[i], at[j], H(row, static_cast<int>(j)));
  }
}

}  // namespace

Corrections solve(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected) {
  const double info = information(expected.pair);
  const Eigen::Vector3d sum = std::accumulate(now.rotations.begin(), now.rotations.end(), Eigen::Vector3d(0, 0, 0));
  std::vector<double> trust(models.size(), 1);
  Eigen::VectorXd change;
  for (int round = 0; round < kRounds; ++round) {
    Normal normal(now.rotations.size());
    add_priors(normal, now, expected);
    for (std::size_t i = 0; i < models.size(); ++i) add_pair(normal, models[i], now.rotations.size(), trust[i] * info);
    change = expected.common ? normal.solve() : normal.solve_without_common(sum);
    for (std::size_t i = 0; i < models.size(); ++i) {
      Vector6d own = Vector6d::Zero();
      const auto at = places(models[i]);
      for (std::size_t k = 0; k < unknowns(models[i], now.rotations.size()); ++k) own[static_cast<int>(k)] = change[at[k]];
      const Vector6d error = error_by_gradient(models[i], trust[i] * info) * (models[i].g + models[i].H * own);
      trust[i] = 1 / (1 + (error.head<3>() - error.tail<3>()).squaredNorm() * info / 4);  // Cauchy, at twice the expected size
    }
  }
  Corrections out = now;
  out.mounting += change.segment<3>(kMounting);
  for (std::size_t i = 0; i < now.rotations.size(); ++i)
    out.rotations[i] += change.segment<3>(kViews + 3 * static_cast<int>(i));
  return out;
}

}  // namespace dvi::align
