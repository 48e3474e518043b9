#pragma once

#include <Eigen/Core>

namespace dvi {

/// The count, sum and sum of outer products of points, from which mean and covariance follow. Points must be given relative to
/// an origin near them; otherwise, covariance() is dominated by rounding errors.
template <class Scalar>
struct Moments {
  using Vector = Eigen::Matrix<Scalar, 3, 1>;
  using Matrix = Eigen::Matrix<Scalar, 3, 3>;

  int count = 0;
  Vector sum = Vector::Zero();
  Matrix squares = Matrix::Zero();

  void add(const Vector& x) {
    ++count;
    sum += x;
    squares += x * x.transpose();
  }
  /// Removes a point that was added before.
  void remove(const Vector& x) {
    --count;
    sum -= x;
    squares -= x * x.transpose();
  }
  /// Adds the moments of other points, whose origin lies at `offset` from this one.
  void add(const Moments& other, const Vector& offset) {
    const auto n = static_cast<Scalar>(other.count);
    count += other.count;
    sum += other.sum + n * offset;
    squares +=
        other.squares + other.sum * offset.transpose() + offset * other.sum.transpose() + n * offset * offset.transpose();
  }

  Vector mean() const { return sum / static_cast<Scalar>(count); }
  /// Returns the covariance, normalized by the count. The normal of the plane through the points is its eigenvector with the
  /// smallest eigenvalue.
  Matrix covariance() const {
    const Vector m = mean();
    return squares / static_cast<Scalar>(count) - m * m.transpose();
  }
};

}  // namespace dvi
