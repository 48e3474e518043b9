#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/geometry/moments.h"
#include "dvi/scan_match/voxel_key.h"

namespace dvi::scan_match {

/// The shape of the points of one voxel.
struct Shape {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();      ///< meters, world
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns in order of increasing variance
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();  ///< along the axes, m^2
  double count = 0;                                    ///< number of points
  int thin = 0;                                        ///< number of thin axes: 1 for a plane, 2 for a line, 0 otherwise
};

/// The scene around the vehicle as means and covariances of voxels (as in NDT and VGICP). Since odometry spends most of its
/// time in at(), a table of 16 bytes per voxel answers with one memory access, in most cases, whether a shape exists.
class LocalMap {
 public:
  explicit LocalMap(double voxel_m);

  void add(const Eigen::Vector3d& point) { change(point, 1); }
  /// Removes a point that was added before.
  void remove(const Eigen::Vector3d& point) { change(point, -1); }
  /// Returns the shape of the voxel that contains a point; null if the voxel has too few points or its shape does not have
  /// `thin` thin axes. (A single beam draws a line on a plane, so planes and lines must be distinguished.) The pointer is valid
  /// until the map changes.
  const Shape* at(const Eigen::Vector3d& point, int thin);
  /// Calls look(shape) for each shape in unspecified order.
  template <class Look>
  void each(const Look& look) {
    for (Voxel& voxel : voxels_)
      if (const Shape* shape = shape_of(voxel)) look(*shape);
  }
  /// Drops voxels farther than `radius_m` from a position.
  void keep_near(const Eigen::Vector3d& position, double radius_m);
  std::size_t size() const { return voxels_.size(); }

 private:
  struct Voxel {
    VoxelKey key;
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // origin of the moments
    Moments<double> moments;
    bool fitted = false;
    Shape shape;
  };
  /// A slot of the table, which is searched from the key's hash onward.
  struct Slot {
    VoxelKey key = 0;
    std::uint32_t voxel = kFree;  // index in voxels_
    std::int8_t thin = kUnknown;  // thin axes of its shape; 0 as well if it has no shape
  };
  static constexpr std::uint32_t kFree = UINT32_MAX;
  static constexpr std::int8_t kUnknown = -1;

  void change(const Eigen::Vector3d& point, int sign);
  /// Returns the slot of a key, or the free slot for it.
  Slot& slot_of(VoxelKey key);
  /// Rebuilds the table with a power of two of slots.
  void index(std::size_t slots);
  const Shape* shape_of(Voxel& voxel) const;
  void fit(Voxel& voxel) const;

  double voxel_m_;
  std::vector<Voxel> voxels_;
  std::vector<Slot> slots_;  // at most half of them are used
};

}  // namespace dvi::scan_match
