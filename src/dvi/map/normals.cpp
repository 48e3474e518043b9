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

constexpr double kNeighborhood = 0.2;  // meters
constexpr int kFewest = 6;             // points
constexpr float kWidth = 0.08F;  // meters, standard deviation: a strip narrower than four times the range noise has no normal
constexpr float kFlat = 0.25F;   // a plane's smallest variance is at most this share of the middle one
constexpr std::size_t kTilesInMemory = 32;  // of a map that is paged to disk

struct Cell {
  Moments<float> moments;  // from the cell's center, so that float does
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
};

using Cells = VoxelGrid<Cell>;

Eigen::Vector3f normal_at(const Cells& cells, const Eigen::Vector3i& place) {
  Moments<float> all;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3i step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (const Cell* cell = cells.look(place + step))
      all.add(cell->moments, step.cast<float>() * static_cast<float>(kNeighborhood));
  }
  if (all.count < kFewest) return Eigen::Vector3f::Zero();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(all.covariance());
  if (solver.eigenvalues()[1] < kWidth * kWidth) return Eigen::Vector3f::Zero();
  if (solver.eigenvalues()[0] > kFlat * solver.eigenvalues()[1]) return Eigen::Vector3f::Zero();
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
  Cells cells(kNeighborhood, map.scratch());
  for_each_point(map, [&](const MapPoint& point) {
    const Eigen::Vector3d x = point.position.cast<double>();
    cells.at(x).moments.add((x - cells.center(cells.place(x))).cast<float>());
  });
  std::vector<Cells::Tile*> tiles;
  for (auto& [column, tile] : cells.tiles()) tiles.push_back(&tile);
  for (std::size_t first = 0; first < tiles.size(); first += kTilesInMemory) {
    parallel_for(std::min(kTilesInMemory, tiles.size() - first), [&](std::size_t t) {
      Cells::Tile& tile = *tiles[first + t];
      for (std::size_t i = 0; i < tile.voxels.size(); ++i) tile.voxels[i].normal = normal_at(cells, tile.places[i]);
    });
    map.page_out();
  }
  for_each_point(map, [&](MapPoint& point) {
    point.normal = cells.at(point.position.cast<double>()).normal;
    if (point.normal.dot(map.scans[point.first].sensor - point.position) < 0) point.normal *= -1;
  });
}

}  // namespace dvi::map
