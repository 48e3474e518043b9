#include "dvi/scan_match/local_map.h"

#include <Eigen/Eigenvalues>

namespace dvi::scan_match {
namespace {

constexpr int kMinPoints = 6;  // in a voxel
constexpr std::size_t kMinSlots = 1024;

}  // namespace

LocalMap::LocalMap(double voxel_m) : voxel_m_(voxel_m), slots_(kMinSlots) {}

void LocalMap::change(const Eigen::Vector3d& point, int sign) {
  const VoxelKey key = voxel_key(point, voxel_m_);
  if (sign > 0 && 2 * (voxels_.size() + 1) > slots_.size()) index(2 * slots_.size());
  Slot& slot = slot_of(key);
  if (slot.voxel == kFree) {
    if (sign < 0) return;  // the voxel was dropped since
    slot = {key, static_cast<std::uint32_t>(voxels_.size()), kUnknown};
    voxels_.push_back({key, point, {}, false, {}});
  }
  Voxel& voxel = voxels_[slot.voxel];
  const Eigen::Vector3d x = point - voxel.origin;
  sign > 0 ? voxel.moments.add(x) : voxel.moments.remove(x);
  voxel.fitted = false;
  slot.thin = kUnknown;
}

const Shape* LocalMap::at(const Eigen::Vector3d& point, int thin) {
  Slot& slot = slot_of(voxel_key(point, voxel_m_));
  if (slot.voxel == kFree || (slot.thin != kUnknown && slot.thin != thin)) return nullptr;
  const Shape* shape = shape_of(voxels_[slot.voxel]);
  slot.thin = static_cast<std::int8_t>(shape != nullptr ? shape->thin : 0);
  return slot.thin == thin ? shape : nullptr;
}

LocalMap::Slot& LocalMap::slot_of(VoxelKey key) {
  const std::size_t last = slots_.size() - 1;
  std::size_t i = VoxelHash()(key) & last;
  while (slots_[i].voxel != kFree && slots_[i].key != key) i = (i + 1) & last;
  return slots_[i];
}

void LocalMap::index(std::size_t slots) {
  slots_.assign(slots, {});
  for (std::size_t i = 0; i < voxels_.size(); ++i)
    slot_of(voxels_[i].key) = {voxels_[i].key, static_cast<std::uint32_t>(i), kUnknown};
}

const Shape* LocalMap::shape_of(Voxel& voxel) const {
  if (voxel.moments.count < kMinPoints) return nullptr;
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
  const double thick = std::max(0.01, 0.0036 * voxel_m_ * voxel_m_);  // variance; a plane as wide as the voxel has voxel^2 / 12
  const double wide = 0.01 * voxel_m_ * voxel_m_;
  shape.thin = 0;
  if (shape.variance[0] < thick && shape.variance[1] > wide && shape.variance[0] < 0.1 * shape.variance[1])
    shape.thin = 1;
  else if (shape.variance[1] < thick && shape.variance[2] > wide && shape.variance[1] < 0.1 * shape.variance[2])
    shape.thin = 2;
  voxel.fitted = true;
}

void LocalMap::keep_near(const Eigen::Vector3d& position, double radius_m) {
  const auto far = [&](const Voxel& voxel) { return (voxel.origin - position).squaredNorm() > radius_m * radius_m; };
  if (std::erase_if(voxels_, far) > 0) index(slots_.size());
}

}  // namespace dvi::scan_match
