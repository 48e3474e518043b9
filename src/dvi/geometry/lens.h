#pragma once

#include <array>

#include <Eigen/Core>

namespace dvi {

/// The distortion of OpenCV's pinhole model, in the plane z = 1: Brown's, or the rational one. The unified model applies it
/// behind its sphere.
class PlaneDistortion {
 public:
  /// The coefficients are k1, k2, p1, p2, k3, k4, k5, k6.
  explicit PlaneDistortion(const std::array<double, 8>& coefficients) : k_(coefficients) {}

  Eigen::Vector2d distort(const Eigen::Vector2d& n) const;
  /// Returns the derivative of distort().
  Eigen::Matrix2d differentiate(const Eigen::Vector2d& n) const;
  /// Returns the position that is distorted to `d`; without one, a finite position outside.
  Eigen::Vector2d undistort(const Eigen::Vector2d& d) const;
  /// Returns whether the radius after distortion increases from the center up to a squared radius before it.
  bool increases_to(double r2) const;

 private:
  /// The factor of the radius, and its derivative with respect to the squared radius.
  struct Radial {
    double factor, slope;
  };
  Radial radial(double r2) const;
  bool is_rational() const { return k_[5] != 0 || k_[6] != 0 || k_[7] != 0; }

  const std::array<double, 8>& k_;
};

/// The distortion of the fisheye model: the radius in the image, in focal lengths, of an angle off the optical axis.
class AngleDistortion {
 public:
  /// The angle in radians beyond which no direction is projected; the image of the opposite direction would be a circle.
  static constexpr double kMaxAngle = 3.05;

  /// The coefficients k1 to k4 are the first four.
  explicit AngleDistortion(const std::array<double, 8>& coefficients) : k_(coefficients) {}

  double radius(double angle) const;
  double slope(double angle) const;
  /// Returns the angle of a radius; without one, the last up to which the radius increases.
  double angle(double radius) const;
  /// Returns whether the radius increases from the axis to an angle, and the angle has a projection.
  bool increases_to(double angle) const;

 private:
  const std::array<double, 8>& k_;
};

}  // namespace dvi
