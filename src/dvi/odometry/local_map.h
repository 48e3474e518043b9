#pragma once

#include <unordered_map>

#include <Eigen/Core>

#include "dvi/geometry/moments.h"
#include "dvi/odometry/voxel_key.h"

namespace dvi::odometry {

/// What the points of one voxel look like.
struct Shape {
  Eigen::Vector3d mean;      ///< metres, world
  Eigen::Matrix3d axes;      ///< columns: thinnest first
  Eigen::Vector3d variance;  ///< along the axes, m^2
  double count = 0;          ///< of points
  int thin = 0;              ///< along how many axes it is thin: 1 a plane, 2 a line, 0 neither
};

/// The scene round the car as means and covariances of voxels (as in NDT and VGICP).
class LocalMap {
 public:
  explicit LocalMap(double voxel_m) : voxel_m_(voxel_m) {}

  void add(const Eigen::Vector3d& point) { change(point, 1); }
  /// Takes back a point that was added.
  void remove(const Eigen::Vector3d& point) { change(point, -1); }
  /// The shape that holds a point; none where too few points lie in its voxel, or it is not thin along that many axes. (One
  /// beam draws a line on a plane, where it happened to look: planes and lines must not be taken for each other.)
  const Shape* at(const Eigen::Vector3d& point, int thin);
  /// Calls look(shape) for every shape there is, in no order.
  template <class Look>
  void each(const Look& look) {
    for (auto& [key, voxel] : voxels_)
      if (const Shape* shape = shape_of(voxel)) look(*shape);
  }
  /// Drops voxels farther than this from a position.
  void keep_near(const Eigen::Vector3d& position, double radius_m);
  std::size_t size() const { return voxels_.size(); }

 private:
  struct Voxel {
    Eigen::Vector3d origin;  // of the moments
    Moments<double> moments;
    bool fitted = false;
    Shape shape;
  };
  void change(const Eigen::Vector3d& point, int sign);
  const Shape* shape_of(Voxel& voxel) const;
  void fit(Voxel& voxel) const;

  double voxel_m_;
  std::unordered_map<VoxelKey, Voxel, VoxelHash> voxels_;
};

}  // namespace dvi::odometry
