#include "dvi/map/carve.h"

#include <cmath>
#include <set>
#include <utility>

#include "dvi/core/scratch.h"
#include "dvi/core/threads.h"
#include "dvi/drive/free_space.h"

namespace dvi::map {
namespace {

using Tile = MapVoxels::Tile;

/// Returns the columns of tiles within the range of the scans.
std::set<std::pair<int, int>> find_columns_in_range(const std::vector<FreeSpace>& spaces) {
  constexpr double kMaxDistanceM = FreeSpace::kMaxRangeM + MapVoxels::kTileM;
  const auto tile_of = [](double meters) { return static_cast<int>(std::floor(meters / MapVoxels::kTileM)); };
  std::set<std::pair<int, int>> near;
  for (const FreeSpace& space : spaces) {
    if (!space.valid()) continue;
    const Eigen::Vector2d at = space.sensor().head<2>();
    for (int x = tile_of(at.x() - kMaxDistanceM); x <= tile_of(at.x() + kMaxDistanceM); ++x)
      for (int y = tile_of(at.y() - kMaxDistanceM); y <= tile_of(at.y() + kMaxDistanceM); ++y)
        if ((at - MapVoxels::kTileM * Eigen::Vector2d(x + 0.5, y + 0.5)).norm() < kMaxDistanceM) near.emplace(x, y);
  }
  return near;
}

/// Concludes from the counts of one drive and resets them.
void conclude(MapVoxel& voxel, std::size_t drive) {
  const std::uint32_t bit = MapPoint::drive_bit(drive);
  if (voxel.passes > kCarving.max_pass_ratio * static_cast<double>(voxel.hits))
    voxel.absent |= bit;
  else if (voxel.hits > 0)
    voxel.present |= bit;
  voxel.hits = voxel.passes = 0;
}

void count_for_tile(MapVoxels& voxels, Tile& tile, const std::vector<FreeSpace>& spaces) {
  const double radius = 0.5 * voxels.edge();
  for (std::size_t i = 0; i < tile.voxels.size(); ++i) {
    MapVoxel& voxel = tile.voxels[i];
    const Eigen::Vector3d point = compute_mean(voxels, tile.indices[i], voxel);
    for (const FreeSpace& space : spaces) {
      if (!space.valid()) continue;
      const FreeSpace::Seen seen = space.judge(point, radius);
      if (seen == FreeSpace::Seen::hit && voxel.hits < UINT16_MAX) ++voxel.hits;
      if (seen == FreeSpace::Seen::passed && voxel.passes < UINT16_MAX) ++voxel.passes;
    }
  }
}

}  // namespace

void count_hits_and_passes(MapVoxels& voxels, const std::vector<MapInput>& inputs, double pose_error_m, const Tick& tick) {
  for (std::size_t drive = 0; drive < inputs.size(); ++drive) {
    const MapInput& input = inputs[drive];
    const std::vector<ScanHeader>& scan_headers = input.drive->scan_headers;
    std::set<std::pair<int, int>> reached;  // columns in the range of this drive
    for_blocks(scan_headers.size(), [&](std::size_t first, std::size_t last) {
      std::vector<FreeSpace> spaces(last - first);
      parallel_for(spaces.size(), [&](std::size_t i) {
        spaces[i] = FreeSpace(*input.drive->scans[first + i], scan_headers[first + i], input.world_from_lidar, pose_error_m);
      });
      std::vector<Tile*> near;
      for (const auto& column : find_columns_in_range(spaces))
        if (const auto tile = voxels.tiles().find(column); tile != voxels.tiles().end()) {
          near.push_back(&tile->second);
          reached.insert(column);
        }
      parallel_for(near.size(), [&](std::size_t i) { count_for_tile(voxels, *near[i], spaces); });
      voxels.page_out();
      for (std::size_t i = first; i < last; ++i) tick();
    });
    std::size_t concluded = 0;
    for (const auto& column : reached)
      for (MapVoxel& voxel : voxels.tiles().at(column).voxels) {
        conclude(voxel, drive);
        page_out_sometimes(concluded++);
      }
    voxels.page_out();
  }
}

bool has_moved(const MapVoxel& voxel) { return voxel.absent != 0 && voxel.present == 0; }

}  // namespace dvi::map
