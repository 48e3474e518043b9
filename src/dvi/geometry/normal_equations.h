#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace dvi {

/// Solves the normal equations A x = right, where A is sparse, symmetric and positive definite, and `right` may have several
/// columns. Entries with the same indices are added in their order. Only the lower half of A is used. Throws std::logic_error
/// if A is singular. Takes a few milliseconds for a chain of a thousand unknowns.
Eigen::MatrixXd solve_normal_equations(const std::vector<Eigen::Triplet<double>>& entries, const Eigen::MatrixXd& right);

}  // namespace dvi
