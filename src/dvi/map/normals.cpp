#include "dvi/map/normals.h"

#include <algorithm>
#include <vector>

#include <Eigen/Eigenvalues>

#include "dvi/core/scratch.h"
#include "dvi/core/threads.h"
#include "dvi/geometry/moments.h"
#include "dvi/map/voxel_grid.h"

namespace dvi::map {
namespace {

struct Cell {
  Moments<float> moments;  // relative to the center of the cell, so that float is precise enough
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
};

using Cells = VoxelGrid<Cell>;

Eigen::Vector3f estimate_normal(const Cells& cells, const Eigen::Vector3i& index) {
  Moments<float> all;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3i step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (const Cell* cell = cells.find(index + step))
      all.add(cell->moments, step.cast<float>() * static_cast<float>(kMapNormal.cell_m));
  }
  if (all.count < kMapNormal.min_points) return Eigen::Vector3f::Zero();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(all.covariance());
  if (solver.eigenvalues()[1] < kMapNormal.min_width_m * kMapNormal.min_width_m) return Eigen::Vector3f::Zero();
  if (solver.eigenvalues()[0] > kMapNormal.max_flatness * solver.eigenvalues()[1]) return Eigen::Vector3f::Zero();
  return solver.eigenvectors().col(0);
}

template <class Visit>
void for_each_point(StaticMap& map, const Visit& visit) {
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    visit(map.points[i]);
    page_out_sometimes(i);
  }
}

}  // namespace

void add_normals(StaticMap& map) {
  Cells cells(kMapNormal.cell_m, map.scratch());
  for_each_point(map, [&](const MapPoint& point) {
    const Eigen::Vector3d x = point.position.cast<double>();
    cells.at(x).moments.add((x - cells.center(cells.index(x))).cast<float>());
  });
  std::vector<Cells::Tile*> tiles;
  for (auto& [column, tile] : cells.tiles()) tiles.push_back(&tile);
  for (std::size_t first = 0; first < tiles.size(); first += kMapNormal.tiles_in_memory) {
    parallel_for(std::min(kMapNormal.tiles_in_memory, tiles.size() - first), [&](std::size_t t) {
      Cells::Tile& tile = *tiles[first + t];
      for (std::size_t i = 0; i < tile.voxels.size(); ++i) tile.voxels[i].normal = estimate_normal(cells, tile.indices[i]);
    });
    map.page_out();
  }
  for_each_point(map, [&](MapPoint& point) {
    point.normal = cells.at(point.position.cast<double>()).normal;
    if (point.normal.dot(map.scans[point.first].sensor - point.position) < 0) point.normal *= -1;
  });
}

}  // namespace dvi::map
