#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/scratch.h"

namespace dvi::map {

/// A sparse grid of cubes in tiles, which are vertical columns of kTileM meters: local work does not touch the other tiles.
/// Voxels are created on first access and stored in this order; tiles are in the order of their coordinates. No order depends
/// on the hash. Coordinates are limited to a million voxels from the origin.
template <class Voxel>
class VoxelGrid {
 public:
  static constexpr double kTileM = 16;

  class Tile {
   public:
    explicit Tile(const std::shared_ptr<Scratch>& scratch) : voxels(scratch), indices(scratch), slots_(scratch) {}

    ScratchVector<Voxel> voxels;
    ScratchVector<Eigen::Vector3i> indices;  ///< per voxel: position / edge, rounded down

    /// Returns the voxel, which is created if necessary.
    Voxel& at(const Eigen::Vector3i& index) {
      if (2 * (voxels.size() + 1) > slots_.size()) grow();
      std::uint32_t& slot = slots_[find_slot(index)];
      if (slot == 0) {
        voxels.emplace_back();
        indices.push_back(index);
        slot = static_cast<std::uint32_t>(voxels.size());
      }
      return voxels[slot - 1];
    }
    /// Returns the voxel, or null if it does not exist.
    const Voxel* find(const Eigen::Vector3i& index) const {
      if (slots_.empty()) return nullptr;
      const std::uint32_t slot = slots_[find_slot(index)];
      return slot == 0 ? nullptr : &voxels[slot - 1];
    }

   private:
    // Returns the slot of a voxel, or the free slot that it would take.
    std::size_t find_slot(const Eigen::Vector3i& index) const {
      const auto mix = [](int v, std::uint64_t prime) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) * prime;
      };
      std::uint64_t hash =
          mix(index.x(), 0x9E3779B97F4A7C15) + mix(index.y(), 0xC2B2AE3D27D4EB4F) + mix(index.z(), 0x165667B19E3779F9);
      std::size_t i = (hash ^ (hash >> 32)) & (slots_.size() - 1);
      while (slots_[i] != 0 && indices[slots_[i] - 1] != index) i = (i + 1) & (slots_.size() - 1);
      return i;
    }
    void grow() {
      slots_.assign(slots_.empty() ? 64 : 2 * slots_.size(), 0);
      for (std::size_t k = 0; k < indices.size(); ++k) slots_[find_slot(indices[k])] = static_cast<std::uint32_t>(k + 1);
    }

    ScratchVector<std::uint32_t> slots_;  // index in voxels + 1, or 0 if free; the size is a power of two, at most half is used
  };
  using Tiles = std::map<std::pair<int, int>, Tile>;

  explicit VoxelGrid(double edge, std::shared_ptr<Scratch> scratch = {}) : edge_(edge), scratch_(std::move(scratch)) {}

  double edge() const { return edge_; }
  /// Moves data beyond the memory bound to disk until it is used again.
  void page_out() const {
    if (scratch_) scratch_->page_out();
  }
  Tiles& tiles() { return tiles_; }
  const Tiles& tiles() const { return tiles_; }

  Eigen::Vector3i index(const Eigen::Vector3d& point) const { return (point / edge_).array().floor().cast<int>(); }
  Eigen::Vector3d center(const Eigen::Vector3i& index) const { return edge_ * (index.cast<double>().array() + 0.5); }

  Voxel& at(const Eigen::Vector3d& point) {
    const Eigen::Vector3i p = index(point);
    return tiles_.try_emplace(column(p), scratch_).first->second.at(p);
  }
  const Voxel* find(const Eigen::Vector3i& index) const {
    const auto tile = tiles_.find(column(index));
    return tile == tiles_.end() ? nullptr : tile->second.find(index);
  }

 private:
  std::pair<int, int> column(const Eigen::Vector3i& index) const {
    const auto to_tile = [&](int k) { return static_cast<int>(std::floor(k * edge_ / kTileM)); };
    return {to_tile(index.x()), to_tile(index.y())};
  }

  double edge_;
  std::shared_ptr<Scratch> scratch_;
  Tiles tiles_;
};

}  // namespace dvi::map
