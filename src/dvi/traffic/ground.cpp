#include "dvi/traffic/ground.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"

namespace dvi::traffic {
namespace {

constexpr double kGroundSquare = 1, kLevel = 0.1;  // metres
constexpr double kGroundReach = 80;                // metres: as far as objects are looked for
constexpr std::size_t kEvery = 4;                  // returns of a scan that are looked at: the ground has plenty
constexpr double kObstacle = 0.3;                  // metres: no kerb is higher
constexpr int kAround = 4;                         // squares each way: a vehicle is not longer
constexpr int kErrors = 3;                         // returns that may be errors
constexpr double kErrorShare = 0.02;               // of a square's returns: likewise

// Returns of one square at one height.
struct Level {
  int x, y, step;
  double z;
};

struct Heap {
  int count = 0;
  double sum = 0;
};

int steps(double v, double size) { return static_cast<int>(std::floor(v / size)); }

std::vector<Level> levels_of(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar) {
  std::vector<Level> levels;
  const std::vector<Eigen::Vector3d> world = to_world(scan, header, world_from_lidar, kEvery);
  for (std::size_t i = 0; i < world.size(); i += kEvery) {
    const Eigen::Vector3d& x = world[i];
    if (scan.points[i].norm() > kGroundReach) continue;
    levels.push_back({steps(x.x(), kGroundSquare), steps(x.y(), kGroundSquare), steps(x.z(), kLevel), x.z()});
  }
  return levels;
}

// The mean of the lowest two levels in a row that hold more than errors.
std::optional<double> lowest(const std::map<int, Heap>& heaps) {
  int all = 0;
  for (const auto& [step, heap] : heaps) all += heap.count;
  for (const auto& [step, heap] : heaps) {
    Heap here = heap;
    if (const auto above = heaps.find(step + 1); above != heaps.end())
      here = {here.count + above->second.count, here.sum + above->second.sum};
    if (here.count > kErrors && here.count > kErrorShare * all) return here.sum / here.count;
  }
  return std::nullopt;
}

// Where no ray met the ground, the lowest returns are of what stands on it: they rise above the squares around.
double without_obstacle(const std::map<std::pair<int, int>, double>& lows, const std::pair<int, int>& square) {
  std::vector<double> around;
  for (int dy = -kAround; dy <= kAround; ++dy)
    for (int dx = -kAround; dx <= kAround; ++dx)
      if (const auto other = lows.find({square.first + dx, square.second + dy}); other != lows.end())
        around.push_back(other->second);
  const double usual = median(around), here = lows.at(square);
  return here > usual + kObstacle ? usual : here;
}

}  // namespace

Ground::Ground(const Drive& drive, const Trajectory& world_from_lidar) {
  std::map<Square, std::map<int, Heap>> squares;
  for_blocks(drive.scan_headers.size(), [&](std::size_t first, std::size_t last) {
    std::vector<std::vector<Level>> levels(last - first);
    parallel_for(levels.size(), [&](std::size_t i) {
      levels[i] = levels_of(*drive.scans[first + i], drive.scan_headers[first + i], world_from_lidar);
    });
    for (const std::vector<Level>& scan : levels)
      for (const Level& level : scan) {
        Heap& heap = squares[{level.x, level.y}][level.step];
        ++heap.count;
        heap.sum += level.z;
      }
  });
  std::map<Square, double> lows;
  for (const auto& [square, heaps] : squares)
    if (const auto height = lowest(heaps)) lows.emplace(square, *height);
  for (const auto& [square, low] : lows) heights_.emplace(square, without_obstacle(lows, square));
}

std::optional<double> Ground::height(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d at = place / kGroundSquare - Eigen::Vector2d::Constant(0.5);  // squares are known at their middle
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  const double u = at.x() - x, v = at.y() - y;
  double sum = 0, weights = 0;
  for (const int dy : {0, 1})
    for (const int dx : {0, 1}) {
      const auto found = heights_.find({x + dx, y + dy});
      if (found == heights_.end()) continue;
      const double weight = (dx ? u : 1 - u) * (dy ? v : 1 - v) + 1e-6;
      sum += weight * found->second;
      weights += weight;
    }
  if (weights > 0) return sum / weights;
  return nearest(steps(place.x(), kGroundSquare), steps(place.y(), kGroundSquare));
}

std::optional<double> Ground::nearest(int x, int y) const {
  for (int reach = 1; reach <= 2; ++reach) {
    std::optional<double> low;
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) {
        const auto found = heights_.find({x + dx, y + dy});
        if (found != heights_.end() && (!low || found->second < *low)) low = found->second;
      }
    if (low) return low;
  }
  return std::nullopt;
}

}  // namespace dvi::traffic
