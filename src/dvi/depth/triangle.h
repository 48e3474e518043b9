#pragma once

#include <array>

#include "dvi/depth/surfel_mesh.h"

namespace dvi::depth {

/// What is seen within a triangle of three surfels: one surface, or several that meet in it or hide each other.
class Triangle {
 public:
  struct Value {
    float inverse = 0;  ///< 1 / meters
    float spread = 0;   ///< meters: how far off it may be beside the noise of the returns
    int corner = 0;     ///< whose surface it is
  };

  Triangle(const SurfelMesh& mesh, const std::array<std::size_t, 3>& corners);

  const Surfel& corner(int k) const { return *corners_[k]; }
  /// Wider than returns lie apart: nothing was scanned within.
  bool gap() const { return gap_; }
  /// At a pixel with the weights `w` of the corners. One surface is interpolated linearly in inverse depth, exact for planes.
  Value at(float x, float y, const std::array<float, 3>& w) const;
  /// Interpolates whatever the corners are.
  Value interpolate(const std::array<float, 3>& w) const;

 private:
  Joint joint_of(int a, int b) const { return joints_[a + b - 1]; }
  float cut_of(int a, int b) const { return cuts_[a + b - 1]; }
  Value shown(float x, float y, const std::array<float, 3>& w) const;
  Value own(int k, float x, float y) const;
  Value meet(int a, int b, float x, float y, const std::array<float, 3>& w) const;
  static Value meet(Joint how, const Value& a, const Value& b);

  std::array<const Surfel*, 3> corners_;  ///< from near to far
  std::array<Joint, 3> joints_{};         ///< of corners 0-1, 0-2, 1-2
  std::array<float, 3> cuts_{};           ///< part of the way between them, from the nearer, that belongs to it
  bool whole_ = false;
  bool gap_ = false;
  int lone_ = -1;  ///< the corner that a step parts from both others
};

}  // namespace dvi::depth
