#include "dvi/geometry/normal_equations.h"

#include <stdexcept>

#include <Eigen/SparseCholesky>

namespace dvi {

Eigen::MatrixXd solve_normal_equations(const std::vector<Eigen::Triplet<double>>& entries, const Eigen::MatrixXd& right) {
  if (right.size() == 0) return right;
  Eigen::SparseMatrix<double> matrix(right.rows(), right.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) throw std::logic_error("normal equations: the matrix is singular");
  return solver.solve(right);
}

}  // namespace dvi
