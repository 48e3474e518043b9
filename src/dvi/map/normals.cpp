#include "dvi/map/normals.h"

#include <Eigen/Eigenvalues>

#include "dvi/core/threads.h"
#include "dvi/geometry/moments.h"
#include "dvi/map/voxel_grid.h"

namespace dvi::map {
namespace {

constexpr double kNeighbourhood = 0.2;  // metres
constexpr int kFewest = 6;              // points
constexpr float kWidth = 0.08F;  // metres, standard deviation: a strip narrower than four times the range noise has no normal
constexpr float kFlat = 0.25F;   // a plane's smallest variance is at most this share of the middle one

struct Cell {
  Moments<float> moments;  // from the cell's centre, so that float does
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
};

using Cells = VoxelGrid<Cell>;

Eigen::Vector3f normal_at(const Cells& cells, const Eigen::Vector3i& place) {
  Moments<float> all;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector3i step(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (const Cell* cell = cells.look(place + step))
      all.add(cell->moments, step.cast<float>() * static_cast<float>(kNeighbourhood));
  }
  if (all.count < kFewest) return Eigen::Vector3f::Zero();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(all.covariance());
  if (solver.eigenvalues()[1] < kWidth * kWidth) return Eigen::Vector3f::Zero();
  if (solver.eigenvalues()[0] > kFlat * solver.eigenvalues()[1]) return Eigen::Vector3f::Zero();
  return solver.eigenvectors().col(0);
}

}  // namespace

void add_normals(StaticMap& map) {
  Cells cells(kNeighbourhood, map.scratch());
  for (const MapPoint& point : map.points) {
    const Eigen::Vector3d x = point.position.cast<double>();
    cells.at(x).moments.add((x - cells.centre(cells.place(x))).cast<float>());
  }
  std::vector<Cells::Tile*> tiles;
  for (auto& [column, tile] : cells.tiles()) tiles.push_back(&tile);
  parallel_for(tiles.size(), [&](std::size_t t) {
    for (std::size_t i = 0; i < tiles[t]->voxels.size(); ++i)
      tiles[t]->voxels[i].normal = normal_at(cells, tiles[t]->places[i]);
  });
  for (MapPoint& point : map.points) {
    point.normal = cells.at(point.position.cast<double>()).normal;
    if (point.normal.dot(map.scans[point.first].sensor - point.position) < 0) point.normal *= -1;
  }
}

}  // namespace dvi::map
