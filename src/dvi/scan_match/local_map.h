#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/geometry/moments.h"
#include "dvi/scan_match/voxel_key.h"

namespace dvi::scan_match {

/// What the points of one voxel look like.
struct Shape {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();      ///< meters, world
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: thinnest first
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();  ///< along the axes, m^2
  double count = 0;                                    ///< of points
  int thin = 0;                                        ///< along how many axes it is thin: 1 a plane, 2 a line, 0 neither
};

/// The scene round the car as means and covariances of voxels (as in NDT and VGICP). Odometry spends most of its time in at():
/// a table of 16 bytes a voxel says, mostly with one look at memory, that there is no such shape.
class LocalMap {
 public:
  explicit LocalMap(double voxel_m);

  void add(const Eigen::Vector3d& point) { change(point, 1); }
  /// Takes back a point that was added.
  void remove(const Eigen::Vector3d& point) { change(point, -1); }
  /// The shape that holds a point; none where too few points lie in its voxel, or it is not thin along that many axes. (One
  /// beam draws a line on a plane, where it happened to look: planes and lines must not be taken for each other.) It holds
  /// until the map changes.
  const Shape* at(const Eigen::Vector3d& point, int thin);
  /// Calls look(shape) for every shape there is, in no order.
  template <class Look>
  void each(const Look& look) {
    for (Voxel& voxel : voxels_)
      if (const Shape* shape = shape_of(voxel)) look(*shape);
  }
  /// Drops voxels farther than this from a position.
  void keep_near(const Eigen::Vector3d& position, double radius_m);
  std::size_t size() const { return voxels_.size(); }

 private:
  struct Voxel {
    VoxelKey key;
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // of the moments
    Moments<double> moments;
    bool fitted = false;
    Shape shape;
  };
  /// Of the table, which is searched from the key's hash onwards.
  struct Slot {
    VoxelKey key = 0;
    std::uint32_t voxel = kFree;  // in voxels_
    std::int8_t thin = kUnknown;  // of its shape; 0 also where it has none
  };
  static constexpr std::uint32_t kFree = UINT32_MAX;
  static constexpr std::int8_t kUnknown = -1;

  void change(const Eigen::Vector3d& point, int sign);
  /// The slot that has a key, or the free one that it would take.
  Slot& slot_of(VoxelKey key);
  /// Makes the table anew, of a power of two of slots.
  void index(std::size_t slots);
  const Shape* shape_of(Voxel& voxel) const;
  void fit(Voxel& voxel) const;

  double voxel_m_;
  std::vector<Voxel> voxels_;
  std::vector<Slot> slots_;  // at most half are taken
};

}  // namespace dvi::scan_match
