#pragma once

#include <Eigen/Core>

namespace dvi {

/// Count, sum and sum of outer products of points: their mean and covariance. Points are given from an origin near them, or
/// the difference of large numbers in covariance() is noise.
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
  /// Takes back a point that was added.
  void remove(const Vector& x) {
    --count;
    sum -= x;
    squares -= x * x.transpose();
  }
  /// Those of other points, whose origin lies at `offset` from this one.
  void add(const Moments& other, const Vector& offset) {
    const auto n = static_cast<Scalar>(other.count);
    count += other.count;
    sum += other.sum + n * offset;
    squares +=
        other.squares + other.sum * offset.transpose() + offset * other.sum.transpose() + n * offset * offset.transpose();
  }

  Vector mean() const { return sum / static_cast<Scalar>(count); }
  /// By the count, not one less. The normal of the plane through the points is the eigenvector of its least eigenvalue.
  Matrix covariance() const {
    const Vector m = mean();
    return squares / static_cast<Scalar>(count) - m * m.transpose();
  }
};

}  // namespace dvi
