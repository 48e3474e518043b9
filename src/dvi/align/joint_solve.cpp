#include "dvi/align/joint_solve.h"

#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "dvi/geometry/normal_equations.h"

namespace dvi::align {
namespace {

constexpr int kIterations = 5;  // each reweights the pairs
/// The error of a pair in the common rotation of its views, over its error in the rotation between them.
constexpr double kCommonErrorRatio = 10;
constexpr int kMountingIndex = 0, kViewsIndex = 3;  // indices of the unknowns

double to_information(double expected) { return 1 / (expected * expected); }

template <int N>
using Square = Eigen::Matrix<double, 2 * N, 2 * N>;
template <int N>
using Column = Eigen::Matrix<double, 2 * N, 1>;

/// The normal equations of the change of the unknowns: mounting, then N corrections per view.
template <int N>
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t views) : right_(Eigen::VectorXd::Zero(kViewsIndex + N * static_cast<int>(views))) {}

  /// Adds to the lower triangle of the matrix.
  void add(int row, int col, double value) {
    if (row >= col) entries_.emplace_back(row, col, value);
  }
  void add_right(int row, double value) { right_[row] += value; }
  /// Adds the cost information * (value + change of an unknown)^2.
  void add_prior(int at, double value, double information) {
    add(at, at, information);
    right_[at] -= information * value;
  }
  Eigen::VectorXd solve() const { return solve_normal_equations(entries_, right_); }
  /// Solves under the constraint that the corrections of all views, whose current sum is `sum`, sum to zero (Lagrange
  /// multipliers).
  Eigen::VectorXd solve_without_common(const Eigen::Matrix<double, N, 1>& sum) const {
    const Eigen::Index views = (right_.size() - kViewsIndex) / N;
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(right_.size(), N + 1);
    columns.col(0) = right_;
    columns.bottomRightCorner(N * views, N) = Eigen::Matrix<double, N, N>::Identity().replicate(views, 1);
    const Eigen::MatrixXd solved = solve_normal_equations(entries_, columns);
    const Eigen::MatrixXd sums = columns.rightCols<N>().transpose() * solved;
    const Eigen::Matrix<double, N, 1> multipliers = sums.rightCols<N>().ldlt().solve(sums.col(0) + sum);
    return solved.col(0) - solved.rightCols<N>() * multipliers;
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

template <int N>
void add_priors(NormalEquations<N>& normal, const Corrections& now, const Expected& expected) {
  for (int k = 0; k < 3; ++k) normal.add_prior(kMountingIndex + k, now.mounting[k], to_information(expected.mounting));
  const double rotation = to_information(expected.rotation);
  for (std::size_t i = 0; i < now.rotations.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int at = kViewsIndex + N * static_cast<int>(i) + k;
      const double apart = now.rotations[i][k] - now.mounting[k];
      normal.add_prior(at, apart, rotation);
      normal.add_prior(kMountingIndex + k, -apart, rotation);
      normal.add(at, kMountingIndex + k, -rotation);
      if constexpr (N == 6) normal.add_prior(at + 3, now.positions[i][k], to_information(expected.position));
    }
}

template <int N>
std::array<int, 2 * N> list_unknowns(const PairModel& model) {
  std::array<int, 2 * N> out{};
  const auto moving = out.begin(), fixed = out.begin() + N;
  std::iota(moving, fixed, kViewsIndex + N * static_cast<int>(model.moving));
  std::iota(fixed, out.end(), kViewsIndex + N * static_cast<int>(model.fixed));
  return out;
}

/// Returns the number of unknowns of a pair; an anchor has none.
template <int N>
std::size_t count_unknowns(const PairModel& model, std::size_t views) {
  return model.fixed < views ? 2 * N : N;
}

template <int N>
Eigen::Array<double, N, 1> get_pair_information(const Expected& expected) {
  Eigen::Array<double, N, 1> out = Eigen::Array<double, N, 1>::Constant(to_information(expected.pair));
  if constexpr (N == 6) out.template tail<3>() = to_information(expected.pair_m);
  return out;
}

/// Returns the linear map from the gradient of a pair to its most probable systematic error: in the correction between its
/// views, with information `info`, and in their common correction, with much less information, because that is only observable
/// by the change of scale from one view to the other, where errors of the surfaces matter.
template <int N>
Square<N> compute_error_from_gradient(const PairModel& model, const Eigen::Array<double, N, 1>& info) {
  Square<N> effect = Square<N>::Zero();
  effect.template topRows<N>() << Eigen::Matrix<double, N, N>::Identity(), Eigen::Matrix<double, N, N>::Identity();
  effect.template bottomRightCorner<N, N>().setIdentity();
  Square<N> inner = effect.transpose() * Eigen::Map<const Square<N>>(model.H.data()) * effect;
  inner.diagonal().template head<N>().array() += info;
  inner.diagonal().template tail<N>().array() += info / (kCommonErrorRatio * kCommonErrorRatio);
  return -effect * inner.ldlt().solve(effect.transpose());
}

/// Adds the cost of a pair with its systematic error marginalized.
template <int N>
void add_pair(NormalEquations<N>& normal, const PairModel& model, std::size_t views, const Eigen::Array<double, N, 1>& info) {
  const Eigen::Map<const Square<N>> given(model.H.data());
  const Square<N> rest = Square<N>::Identity() + given * compute_error_from_gradient<N>(model, info);
  const Square<N> H = rest * given;
  const Column<N> g = rest * Eigen::Map<const Column<N>>(model.g.data());
  const auto at = list_unknowns<N>(model);
  for (std::size_t i = 0; i < count_unknowns<N>(model, views); ++i) {
    const int row = static_cast<int>(i);
    normal.add_right(at[i], -g[row]);
    for (std::size_t j = 0; j < count_unknowns<N>(model, views); ++j) normal.add(at[i], at[j], H(row, static_cast<int>(j)));
  }
}

template <int N>
Corrections solve_with(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected) {
  const Eigen::Array<double, N, 1> info = get_pair_information<N>(expected);
  const std::size_t views = now.rotations.size();
  Eigen::Matrix<double, N, 1> sum = Eigen::Matrix<double, N, 1>::Zero();
  for (std::size_t i = 0; i < views; ++i) {
    sum.template head<3>() += now.rotations[i];
    if constexpr (N == 6) sum.template tail<3>() += now.positions[i];
  }
  std::vector<double> weights(models.size(), 1);
  Eigen::VectorXd change;
  for (int round = 0; round < kIterations; ++round) {
    NormalEquations<N> normal(views);
    add_priors(normal, now, expected);
    for (std::size_t i = 0; i < models.size(); ++i) add_pair<N>(normal, models[i], views, weights[i] * info);
    change = expected.common ? normal.solve() : normal.solve_without_common(sum);
    for (std::size_t i = 0; i < models.size(); ++i) {
      Column<N> own = Column<N>::Zero();
      const auto at = list_unknowns<N>(models[i]);
      for (std::size_t k = 0; k < count_unknowns<N>(models[i], views); ++k) own[static_cast<int>(k)] = change[at[k]];
      const Column<N> gradient =
          Eigen::Map<const Column<N>>(models[i].g.data()) + Eigen::Map<const Square<N>>(models[i].H.data()) * own;
      const Column<N> error = compute_error_from_gradient<N>(models[i], weights[i] * info) * gradient;
      const Eigen::Matrix<double, N, 1> between = error.template head<N>() - error.template tail<N>();
      weights[i] = 1 / (1 + (between.array().square() * info).sum() / 4);  // Cauchy, at twice the expected size
    }
  }
  Corrections out = now;
  out.mounting += change.segment<3>(kMountingIndex);
  for (std::size_t i = 0; i < views; ++i) {
    const auto at = kViewsIndex + N * static_cast<int>(i);
    out.rotations[i] += change.segment<3>(at);
    if constexpr (N == 6) out.positions[i] += change.segment<3>(at + 3);
  }
  return out;
}

}  // namespace

Corrections solve_jointly(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected) {
  return expected.position > 0 ? solve_with<6>(models, now, expected) : solve_with<3>(models, now, expected);
}

}  // namespace dvi::align
