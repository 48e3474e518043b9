#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::depth {

/// A visible point of the map with the plane of its surface, in the image of a view.
struct Surfel {
  float u = 0, v = 0;              ///< Image coordinates in pixels, not rounded.
  float inverse = 0;               ///< Inverse depth, in 1/m.
  float slope_u = 0, slope_v = 0;  ///< Change of the plane's inverse depth per pixel.
  /// Mean of d d^T, in px^2, over the displacements d to neighbors on the same surface.
  Eigen::Matrix2f scatter = Eigen::Matrix2f::Zero();
  float cosine = 1;  ///< Cosine of the angle between the normal and the line of sight, at least 0.005.
  /// Whether the normal was estimated, by the map or from neighbors. Otherwise the plane is vertical and faces the view.
  bool has_normal = false;
  Eigen::Vector3f world = Eigen::Vector3f::Zero();   ///< World coordinates, in meters.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< Unit vector in world axes, toward the view.

  /// The distance in pixels between returns of the surface in a direction; 0 without neighbors. It is exact for grids.
  float spacing(const Eigen::Vector2f& direction) const {
    return std::sqrt(std::max(0.0F, 1.5F * direction.dot(scatter * direction)) / direction.squaredNorm());
  }
  bool is_ground() const { return std::abs(normal.z()) > 0.9F; }
  /// The inverse depth of the plane at a pixel, which is linear in the image; not positive where the plane is behind the view.
  float inverse_at(float x, float y) const { return inverse + slope_u * (x - u) + slope_v * (y - v); }
};

/// Returns the camera center in world coordinates.
inline Eigen::Vector3f camera_center(const View& view) {
  return (-(view.camera_from_world.R.transpose() * view.camera_from_world.t)).cast<float>();
}

/// How the surfaces of two surfels are connected.
enum class Joint : unsigned char {
  same,     ///< Both belong to one surface.
  concave,  ///< Each is in front of the other's plane, as a wall and the ground: the nearer plane is visible.
  convex,   ///< Each is behind the other's plane, as two sides of a box: the farther plane is visible.
  step,     ///< One occludes the other without touching it.
};
/// Determines how the surfaces of two surfels are connected, from their positions and normals.
Joint classify_joint(const Surfel& a, const Surfel& b);

/// The visible points with their planes, and their Delaunay triangles as indices of surfels.
struct SurfelMesh {
  std::vector<Surfel> surfels;
  std::vector<std::array<std::size_t, 3>> triangles;
};

/// Options of make_surfel_mesh().
struct SurfelMeshOptions {
  double splat_m;              ///< An option of map::find_visible_points().
  double occlusion_tolerance;  ///< An option of map::find_visible_points().
  double
      max_slope;  ///< Planes that are steeper in depth (depth over width) are not estimated from neighbors, except the ground.
};

/// Projects the map into a view, triangulates its visible points, and estimates the plane of each.
SurfelMesh make_surfel_mesh(const map::StaticMap& map, const View& view, const SurfelMeshOptions& options);

}  // namespace dvi::depth
