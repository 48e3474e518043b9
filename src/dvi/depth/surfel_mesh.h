#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::depth {

/// A visible point of the map with the plane of the surface it lies on, as a view sees it.
struct Surfel {
  float u = 0, v = 0;                                ///< pixel, sub-pixel exact
  float inverse = 0;                                 ///< 1 / depth, in 1 / meters
  float slope_u = 0, slope_v = 0;                    ///< change of the plane's inverse depth a pixel
  Eigen::Matrix2f ways = Eigen::Matrix2f::Zero();    ///< px^2: mean of w w^T over the ways w to neighbors on its surface
  float cosine = 1;                                  ///< of the angle between its normal and the line of sight, at least 0.005
  bool flat = false;                                 ///< the map knows a normal; else it is taken to face the view, upright
  Eigen::Vector3f world = Eigen::Vector3f::Zero();   ///< meters
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, world axes, toward the view

  /// Pixels between returns on its surface in a direction; 0: it stands alone. Exact for grids.
  float spacing(const Eigen::Vector2f& direction) const {
    return std::sqrt(std::max(0.0F, 1.5F * direction.dot(ways * direction)) / direction.squaredNorm());
  }
  bool is_ground() const { return std::abs(normal.z()) > 0.9F; }
  /// Inverse depth of the plane at a pixel (linear in the image); not positive where the plane is not before the view.
  float inverse_at(float x, float y) const { return inverse + slope_u * (x - u) + slope_v * (y - v); }
};

/// Where the camera is, world axes.
inline Eigen::Vector3f eye_of(const View& view) {
  return (-(view.camera_from_world.R.transpose() * view.camera_from_world.t)).cast<float>();
}

/// How the surfaces of two surfels meet in between.
enum class Joint : unsigned char {
  same,     ///< one surface
  concave,  ///< each lies before the other's plane, as a wall and the ground do: the nearer plane is seen
  convex,   ///< each lies behind the other's plane, as two sides of a box do: the farther plane is seen
  step,     ///< one stands before the other without touching it
};
Joint joint(const Surfel& a, const Surfel& b);

/// The visible points, their planes and their Delaunay triangles.
struct SurfelMesh {
  std::vector<Surfel> surfels;
  std::vector<std::array<std::size_t, 3>> triangles;
};

/// `splat_m`, `occlusion_tolerance`: as visible_points. Planes that leave the view more steeply than `max_slope` (depth over
/// width) are taken from the map, or for the ground, but not guessed from neighbors.
SurfelMesh surfel_mesh(const map::StaticMap& map, const View& view, double splat_m, double occlusion_tolerance,
                       double max_slope);

}  // namespace dvi::depth
