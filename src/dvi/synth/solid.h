#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "dvi/geometry/se3.h"
#include "dvi/synth/texture.h"

namespace dvi::synth {

/// A ray and the change of its direction between pixels (zero: a beam without width).
struct Ray {
  Eigen::Vector3d origin, direction;
  Eigen::Vector3d step_x = Eigen::Vector3d::Zero(), step_y = Eigen::Vector3d::Zero();

  Eigen::Vector3d at(double t) const { return origin + t * direction; }
};

/// The open interval of a ray in which intersections count.
struct RaySpan {
  double near, far;

  bool contains(double t) const { return t > near && t < far; }
};

/// The light of a day: color factors (BGR) of a surface by its normal.
struct Light {
  Eigen::Vector3d to_sun = Eigen::Vector3d::UnitZ();
  cv::Vec3f sun, ambient;

  cv::Vec3f on(const Eigen::Vector3d& normal) const {
    return ambient + sun * static_cast<float>(std::max(0.0, normal.dot(to_sun)));
  }
};

/// A textured trapezoid (two parallel edges) or an upright cylinder.
struct Surface {
  Eigen::Vector3d origin, right, down;  ///< the upper left corner of the bounding parallelogram and its edges
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), dual_right = Eigen::Vector3d::Zero(), dual_down = Eigen::Vector3d::Zero();
  double taper_left = 0, taper_right = 0;  ///< share of `right` missing at the upper edge
  double radius = 0;                       ///< of a cylinder around `origin`, as high as `down`; 0: a trapezoid
  TexturePtr texture;
  cv::Rect2d part;  ///< the part of the texture that covers the surface, in pixels
  cv::Vec3f tint{1, 1, 1};
  bool lit = true;  ///< whether it is lit by its normal; otherwise like the ground (leaves)
};

/// The intersection of a ray with a surface.
struct Hit {
  double t = std::numeric_limits<double>::infinity();
  int surface = -1;
  double x = 0, y = 0;  ///< in pixels of the texture

  explicit operator bool() const { return surface >= 0; }
};

/// Surfaces in a bounding volume hierarchy.
class Solid {
 public:
  /// The corners of a surface as seen from outside. The upper edge is parallel to the lower one and not longer.
  struct Corners {
    Eigen::Vector3d lower_left, lower_right, upper_left, upper_right;
  };
  Surface& add(const Corners& corners, TexturePtr texture);
  /// Adds an upright cylinder on `foot`.
  Surface& add_cylinder(const Eigen::Vector3d& foot, double radius, double height, TexturePtr texture);
  void add(const Solid& other, const SE3& this_from_other);
  /// Builds the hierarchy; must be called after the last add() and before the first trace().
  void finish();

  /// Returns the nearest intersection with t in (near, t_max).
  Hit trace(const Ray& ray, double t_max, double near = 0.3) const;
  cv::Vec3f shade(const Ray& ray, const Hit& hit, const Light& light, double pixel_share = 1) const;

  const std::vector<Surface>& surfaces() const { return surfaces_; }
  /// Return the corners of the bounding box.
  Eigen::Vector3d low() const, high() const;

 private:
  struct Node {
    Eigen::Vector3f low, high;
    int first = 0,
        count = 0;  ///< range in `order_`; with count 0, the node is an inner one, with the children `first` and `first` + 1
  };
  void split(int node, int first, int count, const std::vector<Eigen::AlignedBox3d>& boxes);
  static bool meet(const Surface& surface, const Ray& ray, const RaySpan& span, Hit& hit);

  std::vector<Surface> surfaces_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace dvi::synth
