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

/// A sparse grid of cubes in tiles: columns of kTile meters, so that work near a place need not look at the rest. Voxels are
/// made when first asked for and lie in that order, tiles in the order of their coordinates: no order depends on the hash.
/// Reaches a million voxels from the origin each way.
template <class Voxel>
class VoxelGrid {
 public:
  static constexpr double kTile = 16;

  class Tile {
   public:
    explicit Tile(const std::shared_ptr<Scratch>& scratch) : voxels(scratch), places(scratch), slots_(scratch) {}

    ScratchVector<Voxel> voxels;
    ScratchVector<Eigen::Vector3i> places;  ///< as `voxels`: position / edge, rounded down

    Voxel& at(const Eigen::Vector3i& place) {
      if (2 * (voxels.size() + 1) > slots_.size()) grow();
      std::uint32_t& slot = slots_[find(place)];
      if (slot == 0) {
        voxels.emplace_back();
        places.push_back(place);
        slot = static_cast<std::uint32_t>(voxels.size());
      }
      return voxels[slot - 1];
    }
    const Voxel* look(const Eigen::Vector3i& place) const {
      if (slots_.empty()) return nullptr;
      const std::uint32_t slot = slots_[find(place)];
      return slot == 0 ? nullptr : &voxels[slot - 1];
    }

   private:
    // The slot of a place: its own, or the free one it would take.
    std::size_t find(const Eigen::Vector3i& place) const {
      const auto mix = [](int v, std::uint64_t prime) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) * prime;
      };
      std::uint64_t hash =
          mix(place.x(), 0x9E3779B97F4A7C15) + mix(place.y(), 0xC2B2AE3D27D4EB4F) + mix(place.z(), 0x165667B19E3779F9);
      std::size_t i = (hash ^ (hash >> 32)) & (slots_.size() - 1);
      while (slots_[i] != 0 && places[slots_[i] - 1] != place) i = (i + 1) & (slots_.size() - 1);
      return i;
    }
    void grow() {
      slots_.assign(slots_.empty() ? 64 : 2 * slots_.size(), 0);
      for (std::size_t k = 0; k < places.size(); ++k) slots_[find(places[k])] = static_cast<std::uint32_t>(k + 1);
    }

    ScratchVector<std::uint32_t> slots_;  // index + 1 in voxels; 0: free. A power of two, at most half full.
  };
  using Tiles = std::map<std::pair<int, int>, Tile>;

  explicit VoxelGrid(double edge, std::shared_ptr<Scratch> scratch = {}) : edge_(edge), scratch_(std::move(scratch)) {}

  double edge() const { return edge_; }
  /// Lets what does not fit into memory leave it until it is looked at again.
  void page_out() const {
    if (scratch_) scratch_->page_out();
  }
  Tiles& tiles() { return tiles_; }
  const Tiles& tiles() const { return tiles_; }

  Eigen::Vector3i place(const Eigen::Vector3d& point) const { return (point / edge_).array().floor().cast<int>(); }
  Eigen::Vector3d center(const Eigen::Vector3i& place) const { return edge_ * (place.cast<double>().array() + 0.5); }

  Voxel& at(const Eigen::Vector3d& point) {
    const Eigen::Vector3i p = place(point);
    return tiles_.try_emplace(column(p), scratch_).first->second.at(p);
  }
  const Voxel* look(const Eigen::Vector3i& place) const {
    const auto tile = tiles_.find(column(place));
    return tile == tiles_.end() ? nullptr : tile->second.look(place);
  }

 private:
  std::pair<int, int> column(const Eigen::Vector3i& place) const {
    const auto of = [&](int k) { return static_cast<int>(std::floor(k * edge_ / kTile)); };
    return {of(place.x()), of(place.y())};
  }

  double edge_;
  std::shared_ptr<Scratch> scratch_;
  Tiles tiles_;
};

}  // namespace dvi::map
