#include "dvi/scan_match/pose_graph.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "dvi/geometry/normal_equations.h"
#include "dvi/geometry/skew.h"

namespace dvi::scan_match {
namespace {

// The settings of the optimization.
struct PoseGraphParams {
  double max_squared_error = 30;  // in standard deviations; larger errors give uncertain edges almost no weight
  int iterations = 20;
  double min_step = 1e-7;  // in meters and radians
};
constexpr PoseGraphParams kGraphParams;

Matrix6d compute_adjoint(const SE3& pose) {
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = pose.R;
  out.topRightCorner<3, 3>() = skew(pose.t) * pose.R;
  return out;
}

class Solver {
 public:
  Solver(std::vector<SE3>& poses, const std::vector<PoseEdge>& edges)
      : Solver(poses, edges, std::vector<double>(edges.size(), 1.0)) {}
  Solver(std::vector<SE3>& poses, const std::vector<PoseEdge>& edges, std::vector<double> weights)
      : poses_(poses), edges_(edges), weights_(std::move(weights)) {}

  /// Minimizes by Gauss-Newton, with new weights of uncertain edges in each iteration.
  void settle(double width) {
    for (int i = 0; i < kGraphParams.iterations; ++i) {
      weigh(width);
      if (step() < kGraphParams.min_step) return;
    }
  }

  double worst() const {
    double worst = 0;
    for (const PoseEdge& edge : edges_)
      if (edge.uncertain) worst = std::max(worst, squared(edge));
    return worst;
  }

  void weigh(double width) {
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      const double robust = edges_[k].uncertain ? 1 / (1 + squared(edges_[k]) / width) : 1;
      weights_[k] = robust * robust;
    }
  }

  std::vector<double> weights() && { return std::move(weights_); }

  Matrix6d compute_relative_covariance(std::size_t a, std::size_t b) {
    Eigen::VectorXd right = normal_equations();
    // Each column selects one of the twelve components of the two poses.
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(right.size(), 12);
    const std::array<std::size_t, 2> pose{a, b};
    for (Eigen::Index k = 0; k < 2; ++k)
      if (pose[k] > 0) unit.block<6, 6>(static_cast<Eigen::Index>(6 * (pose[k] - 1)), 6 * k).setIdentity();
    const Eigen::MatrixXd joint = unit.transpose() * solve_normal_equations(entries_, unit);
    Eigen::Matrix<double, 6, 12> to_relative;
    to_relative << -compute_adjoint(poses_[b].inverse() * poses_[a]), Matrix6d::Identity();
    return to_relative * joint * to_relative.transpose();
  }

 private:
  SE3 between(const PoseEdge& edge) const { return poses_[edge.a].inverse() * poses_[edge.b]; }
  Vector6d error(const PoseEdge& edge) const { return se3_log(edge.a_from_b.inverse() * between(edge)); }
  double squared(const PoseEdge& edge) const {
    const Vector6d e = error(edge);
    return e.dot(edge.information * e);
  }

  // Adds the lower half of the block of two poses; the first pose is not an unknown.
  void put(std::size_t row, std::size_t column, const Matrix6d& block) {
    if (row < column || column == 0) return;
    const auto r = static_cast<int>(6 * (row - 1)), c = static_cast<int>(6 * (column - 1));
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        if (row != column || j <= i) entries_.emplace_back(r + i, c + j, block(i, j));
  }

  // Fills entries_ and returns the right-hand side. The derivative of the error is approximated by the identity, since errors
  // are small if the graph is consistent.
  Eigen::VectorXd normal_equations() {
    const auto unknowns = static_cast<Eigen::Index>(6 * (poses_.size() - 1));
    entries_.clear();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      const PoseEdge& edge = edges_[k];
      const Matrix6d weight = weights_[k] * edge.information, by_a = -compute_adjoint(between(edge).inverse());
      const Vector6d pull = weight * error(edge);
      put(edge.a, edge.a, by_a.transpose() * weight * by_a);
      put(edge.b, edge.b, weight);
      put(edge.a, edge.b, by_a.transpose() * weight);
      put(edge.b, edge.a, weight * by_a);
      if (edge.a > 0) right.segment<6>(static_cast<Eigen::Index>(6 * (edge.a - 1))) -= by_a.transpose() * pull;
      if (edge.b > 0) right.segment<6>(static_cast<Eigen::Index>(6 * (edge.b - 1))) -= pull;
    }
    return right;
  }

  // Performs a step and returns the largest change of a pose.
  double step() {
    const Eigen::VectorXd right = normal_equations();
    const Eigen::VectorXd steps = solve_normal_equations(entries_, right);  // regular, since every pose has an edge
    for (std::size_t i = 1; i < poses_.size(); ++i)
      poses_[i] = poses_[i] * se3_exp(steps.segment<6>(static_cast<Eigen::Index>(6 * (i - 1))));
    return steps.cwiseAbs().maxCoeff();
  }

  std::vector<SE3>& poses_;
  const std::vector<PoseEdge>& edges_;
  std::vector<double> weights_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

std::vector<double> solve_pose_graph(std::vector<SE3>& world_from_body, const std::vector<PoseEdge>& edges) {
  Solver solver(world_from_body, edges);
  if (world_from_body.size() > 1) {
    solver.settle(std::numeric_limits<double>::infinity());
    for (double width = std::max(solver.worst(), kGraphParams.max_squared_error); width > kGraphParams.max_squared_error;
         width /= 2)
      solver.settle(width);
    solver.settle(kGraphParams.max_squared_error);
  }
  solver.weigh(kGraphParams.max_squared_error);
  return std::move(solver).weights();
}

Matrix6d compute_relative_covariance(PoseGraph graph, std::size_t a, std::size_t b) {
  return Solver(graph.world_from_body, graph.edges, std::move(graph.weights)).compute_relative_covariance(a, b);
}

}  // namespace dvi::scan_match
