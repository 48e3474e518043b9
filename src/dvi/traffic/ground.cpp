#include "dvi/traffic/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"

namespace dvi::traffic {
namespace {

constexpr double kGroundSquare = 1, kLevel = 0.1;  // metres
constexpr double kGroundReach = 60;                // metres: beyond, rays meet the ground at less than 2 degrees
constexpr std::size_t kEvery = 4;                  // returns of a scan that are looked at: the ground has plenty
constexpr int kErrors = 3;                         // returns that may be errors
constexpr double kErrorShare = 0.02;               // of a square's returns: likewise

using Level = std::tuple<int, int, int>;  // x, y of the square, height in steps

std::vector<Level> levels_of(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar) {
  std::vector<Level> levels;
  const std::vector<Eigen::Vector3d> world = to_world(scan, header, world_from_lidar, kEvery);
  for (std::size_t i = 0; i < world.size(); i += kEvery) {
    if (scan.points[i].norm() > kGroundReach) continue;
    const auto step = [](double v, double size) { return static_cast<int>(std::floor(v / size)); };
    levels.emplace_back(step(world[i].x(), kGroundSquare), step(world[i].y(), kGroundSquare), step(world[i].z(), kLevel));
  }
  return levels;
}

// The top of the lowest two levels in a row that hold more than errors.
std::optional<double> lowest(const std::map<int, int>& counts) {
  int all = 0;
  for (const auto& [level, count] : counts) all += count;
  for (const auto& [level, count] : counts) {
    const auto above = counts.find(level + 1);
    const int here = count + (above == counts.end() ? 0 : above->second);
    if (here > kErrors && here > kErrorShare * all) return kLevel * (level + 1);
  }
  return std::nullopt;
}

}  // namespace

Ground::Ground(const Drive& drive, const Trajectory& world_from_lidar) {
  std::map<Square, std::map<int, int>> counts;
  for_blocks(drive.scan_headers.size(), [&](std::size_t first, std::size_t last) {
    std::vector<std::vector<Level>> levels(last - first);
    parallel_for(levels.size(), [&](std::size_t i) {
      levels[i] = levels_of(*drive.scans[first + i], drive.scan_headers[first + i], world_from_lidar);
      std::sort(levels[i].begin(), levels[i].end());
    });
    for (const std::vector<Level>& scan : levels)
      for (const auto& [x, y, z] : scan) ++counts[{x, y}][z];
  });
  for (const auto& [square, levels] : counts)
    if (const auto height = lowest(levels)) heights_.emplace(square, *height);
}

std::optional<double> Ground::height(const Eigen::Vector3d& place) const {
  const int x = static_cast<int>(std::floor(place.x() / kGroundSquare)),
            y = static_cast<int>(std::floor(place.y() / kGroundSquare));
  for (int reach = 0; reach <= 2; ++reach) {
    std::optional<double> low;
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) {
        if (std::max(std::abs(dx), std::abs(dy)) != reach) continue;
        const auto found = heights_.find({x + dx, y + dy});
        if (found != heights_.end() && (!low || found->second < *low)) low = found->second;
      }
    if (low) return low;
  }
  return std::nullopt;
}

}  // namespace dvi::traffic
