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

template <int N>
using Square = Eigen::Matrix<double, 2 * N, 2 * N>;
template <int N>
using Column = Eigen::Matrix<double, 2 * N, 1>;

// Normal equations of the unknowns' change: mounting, then N corrections of each view.
template <int N>
class Normal {
 public:
  explicit Normal(std::size_t views) : right_(Eigen::VectorXd::Zero(kViews + N * static_cast<int>(views))) {}

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
  // The change after which the corrections of all views, whose sum is `sum` now, add up to none. By Lagrange multipliers.
  Eigen::VectorXd solve_without_common(const Eigen::Matrix<double, N, 1>& sum) const {
    const Eigen::Index views = (right_.size() - kViews) / N;
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
void add_priors(Normal<N>& normal, const Corrections& now, const Expected& expected) {
  for (int k = 0; k < 3; ++k) normal.add_prior(kMounting + k, now.mounting[k], information(expected.mounting));
  const double rotation = information(expected.rotation);
  for (std::size_t i = 0; i < now.rotations.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int at = kViews + N * static_cast<int>(i) + k;
      const double apart = now.rotations[i][k] - now.mounting[k];
      normal.add_prior(at, apart, rotation);
      normal.add_prior(kMounting + k, -apart, rotation);
      normal.add(at, kMounting + k, -rotation);
      if constexpr (N == 6) normal.add_prior(at + 3, now.positions[i][k], information(expected.position));
    }
}

template <int N>
std::array<int, 2 * N> places(const PairModel& model) {
  std::array<int, 2 * N> out{};
  const auto moving = out.begin(), fixed = out.begin() + N;
  std::iota(moving, fixed, kViews + N * static_cast<int>(model.moving));
  std::iota(fixed, out.end(), kViews + N * static_cast<int>(model.fixed));
  return out;
}

// An anchor has none.
template <int N>
std::size_t unknowns(const PairModel& model, std::size_t views) {
  return model.fixed < views ? 2 * N : N;
}

template <int N>
Eigen::Array<double, N, 1> pair_information(const Expected& expected) {
  Eigen::Array<double, N, 1> out = Eigen::Array<double, N, 1>::Constant(information(expected.pair));
  if constexpr (N == 6) out.template tail<3>() = information(expected.pair_m);
  return out;
}

// What a pair misleads about: the correction between its views, and one that both have in common. The error that explains a
// gradient best, if its square costs `info`; the common part much less: it shows only in how surfaces come nearer from one view
// to the other, and there their shape has a say.
template <int N>
Square<N> error_by_gradient(const PairModel& model, const Eigen::Array<double, N, 1>& info) {
  Square<N> effect = Square<N>::Zero();
  effect.template topRows<N>() << Eigen::Matrix<double, N, N>::Identity(), Eigen::Matrix<double, N, N>::Identity();
  effect.template bottomRightCorner<N, N>().setIdentity();
  Square<N> inner = effect.transpose() * Eigen::Map<const Square<N>>(model.H.data()) * effect;
  inner.diagonal().template head<N>().array() += info;
  inner.diagonal().template tail<N>().array() += info / (kCommon * kCommon);
  return -effect * inner.ldlt().solve(effect.transpose());
}

// The pair's cost when its error is whatever makes it least.
template <int N>
void add_pair(Normal<N>& normal, const PairModel& model, std::size_t views, const Eigen::Array<double, N, 1>& info) {
  const Eigen::Map<const Square<N>> given(model.H.data());
  const Square<N> rest = Square<N>::Identity() + given * error_by_gradient<N>(model, info);
  const Square<N> H = rest * given;
  const Column<N> g = rest * Eigen::Map<const Column<N>>(model.g.data());
  const auto at = places<N>(model);
  for (std::size_t i = 0; i < unknowns<N>(model, views); ++i) {
    const int row = static_cast<int>(i);
    normal.add_right(at[i], -g[row]);
    for (std::size_t j = 0; j < unknowns<N>(model, views); ++j) normal.add(at[i], at[j], H(row, static_cast<int>(j)));
  }
}

template <int N>
Corrections solve_for(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected) {
  const Eigen::Array<double, N, 1> info = pair_information<N>(expected);
  const std::size_t views = now.rotations.size();
  Eigen::Matrix<double, N, 1> sum = Eigen::Matrix<double, N, 1>::Zero();
  for (std::size_t i = 0; i < views; ++i) {
    sum.template head<3>() += now.rotations[i];
    if constexpr (N == 6) sum.template tail<3>() += now.positions[i];
  }
  std::vector<double> trust(models.size(), 1);
  Eigen::VectorXd change;
  for (int round = 0; round < kRounds; ++round) {
    Normal<N> normal(views);
    add_priors(normal, now, expected);
    for (std::size_t i = 0; i < models.size(); ++i) add_pair<N>(normal, models[i], views, trust[i] * info);
    change = expected.common ? normal.solve() : normal.solve_without_common(sum);
    for (std::size_t i = 0; i < models.size(); ++i) {
      Column<N> own = Column<N>::Zero();
      const auto at = places<N>(models[i]);
      for (std::size_t k = 0; k < unknowns<N>(models[i], views); ++k) own[static_cast<int>(k)] = change[at[k]];
      const Column<N> gradient =
          Eigen::Map<const Column<N>>(models[i].g.data()) + Eigen::Map<const Square<N>>(models[i].H.data()) * own;
      const Column<N> error = error_by_gradient<N>(models[i], trust[i] * info) * gradient;
      const Eigen::Matrix<double, N, 1> between = error.template head<N>() - error.template tail<N>();
      trust[i] = 1 / (1 + (between.array().square() * info).sum() / 4);  // Cauchy, at twice the expected size
    }
  }
  Corrections out = now;
  out.mounting += change.segment<3>(kMounting);
  for (std::size_t i = 0; i < views; ++i) {
    const auto at = kViews + N * static_cast<int>(i);
    out.rotations[i] += change.segment<3>(at);
    if constexpr (N == 6) out.positions[i] += change.segment<3>(at + 3);
  }
  return out;
}

}  // namespace

Corrections solve(const std::vector<PairModel>& models, const Corrections& now, const Expected& expected) {
  return expected.position > 0 ? solve_for<6>(models, now, expected) : solve_for<3>(models, now, expected);
}

}  // namespace dvi::align
