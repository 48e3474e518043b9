#pragma once

#include <array>

#include <opencv2/core/types.hpp>

#include "dvi/depth/surfel_mesh.h"

namespace dvi::depth {

/// The corners of a triangle, from near to far.
using Corners = std::array<const Surfel*, 3>;
Corners sort_corners(const SurfelMesh& mesh, const std::array<std::size_t, 3>& corners);

/// The depth within a triangle of three surfels: of one surface, or of several that intersect or occlude each other.
class Triangle {
 public:
  struct Value {
    float inverse = 0;  ///< Inverse depth, in 1/m.
    float spread = 0;   ///< Uncertainty of the depth in meters, in addition to the noise of the returns.
    int corner = 0;     ///< The corner whose surface is visible.
  };

  explicit Triangle(const Corners& corners);

  const Surfel& corner(int k) const { return *corners_[k]; }
  /// Whether the triangle is wider than the spacing of returns, so that its inside was not scanned.
  bool is_gap() const { return is_gap_; }
  /// Computes the depth at a pixel; `w` are its barycentric coordinates. One surface is interpolated linearly in inverse depth,
  /// which is exact for planes. Several surfaces are split.
  Value evaluate(float x, float y, const std::array<float, 3>& w) const;
  /// Interpolates the corners linearly in inverse depth, even if they belong to several surfaces.
  Value interpolate(const std::array<float, 3>& w) const;

 private:
  Joint joint_of(int a, int b) const { return joints_[a + b - 1]; }
  float cut_of(int a, int b) const { return cuts_[a + b - 1]; }
  Value split(const cv::Point2f& at, const std::array<float, 3>& w) const;
  Value evaluate_plane(int k, const cv::Point2f& at) const;
  Value split_pair(int a, int b, const cv::Point2f& at, const std::array<float, 3>& w) const;

  Corners corners_;
  std::array<Joint, 3> joints_{};  ///< The joints of the corners 0-1, 0-2, and 1-2.
  std::array<float, 3> cuts_{};    ///< The part of each edge, from its nearer corner, that belongs to the nearer surface.
  bool is_one_surface_ = false;
  bool is_gap_ = false;
  int isolated_ = -1;  ///< The corner that is separated from both others by steps; -1: none.
};

}  // namespace dvi::depth
