#include "dvi/odometry/local_map.h"

#include <Eigen/Eigenvalues>

namespace dvi::odometry {
namespace {

constexpr int kFewestPoints = 6;  // points in a voxel

}  // namespace

void LocalMap::change(const Eigen::Vector3d& point, int sign) {
  const VoxelKey key = voxel_key(point, voxel_m_);
  if (sign < 0 && !voxels_.contains(key)) return;  // dropped meanwhile
  const auto [it, fresh] = voxels_.try_emplace(key);
  Voxel& voxel = it->second;
  if (fresh) voxel.origin = point;
  const Eigen::Vector3d x = point - voxel.origin;
  sign > 0 ? voxel.moments.add(x) : voxel.moments.remove(x);
  voxel.fitted = false;
}

const Shape* LocalMap::at(const Eigen::Vector3d& point, int thin) {
  const auto it = voxels_.find(voxel_key(point, voxel_m_));
  const Shape* shape = it == voxels_.end() ? nullptr : shape_of(it->second);
  return shape != nullptr && shape->thin == thin ? shape : nullptr;
}

const Shape* LocalMap::shape_of(Voxel& voxel) const {
  if (voxel.moments.count < kFewestPoints) return nullptr;
  if (!voxel.fitted) fit(voxel);
  return voxel.shape.thin > 0 ? &voxel.shape : nullptr;
}

void LocalMap::fit(Voxel& voxel) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(voxel.moments.covariance());
  Shape& shape = voxel.shape;
  shape.count = voxel.moments.count;
  shape.mean = voxel.origin + voxel.moments.mean();
  shape.axes = solver.eigenvectors();
  shape.variance = solver.eigenvalues().cwiseMax(0.0);
  const double thick = std::max(0.01, 0.0036 * voxel_m_ * voxel_m_);  // variance; a plane of the voxel's width has voxel^2 / 12
  const double wide = 0.01 * voxel_m_ * voxel_m_;
  shape.thin = 0;
  if (shape.variance[0] < thick && shape.variance[1] > wide && shape.variance[0] < 0.1 * shape.variance[1])
    shape.thin = 1;
  else if (shape.variance[1] < thick && shape.variance[2] > wide && shape.variance[1] < 0.1 * shape.variance[2])
    shape.thin = 2;
  voxel.fitted = true;
}

void LocalMap::keep_near(const Eigen::Vector3d& position, double radius_m) {
  std::erase_if(voxels_,
                [&](const auto& entry) { return (entry.second.origin - position).squaredNorm() > radius_m * radius_m; });
}

}  // namespace dvi::odometry
