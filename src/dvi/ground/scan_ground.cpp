#include "dvi/ground/scan_ground.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>
#include <vector>

#include <boost/container/flat_map.hpp>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"

namespace dvi::ground {
namespace {

constexpr double kGroundSquare = 1, kLevelM = 0.1;   // meters
constexpr double kGroundReach = 80;                  // meters: as far as objects are looked for
constexpr std::size_t kEvery = 4;                    // returns of a scan that are looked at: the ground has plenty
constexpr double kObstacle = 0.3;                    // meters: no curb is higher
constexpr double kLaneHalfWidthM = 3;                // meters from the way: the lane
constexpr double kMaxCurbM = 0.1, kMaxSlope = 0.15;  // meters, meters a meter: curbs and banks
constexpr double kRise = 0.4;                        // meters at most, however far: a hood is higher
constexpr double kAround = 4;                        // meters: no bank is that long and then ends
constexpr double kReach = 8;                         // meters: between rays on the ground, and below a truck
constexpr int kErrors = 3;                           // returns that may be errors
constexpr double kErrorShare = 0.02;                 // of a square's returns: likewise

// Returns of one square at one height.
struct Level {
  int x, y, step;
  double z;
};

struct Heap {
  int count = 0;
  double sum = 0;
};

// By level. Flat: a square at a wall has a hundred of them, and a drive a hundred thousand squares.
using Heaps = boost::container::flat_map<int, Heap>;

int steps(double v, double size) { return static_cast<int>(std::floor(v / size)); }

std::vector<Level> levels_of(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar) {
  std::vector<Level> levels;
  const std::vector<Eigen::Vector3d> world = to_world(scan, header, world_from_lidar, kEvery);
  for (std::size_t i = 0; i < world.size(); i += kEvery) {
    const Eigen::Vector3d& x = world[i];
    if (scan.points[i].norm() > kGroundReach) continue;
    levels.push_back({steps(x.x(), kGroundSquare), steps(x.y(), kGroundSquare), steps(x.z(), kLevelM), x.z()});
  }
  return levels;
}

// The mean of the lowest two levels in a row that hold more than errors.
std::optional<double> lowest(const Heaps& heaps) {
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

using Square = std::pair<int, int>;

double distance(const Square& a, const Square& b) { return kGroundSquare * std::hypot(a.first - b.first, a.second - b.second); }

template <class Visit>
void for_squares_around(const Square& center, double reach, const Visit& visit) {
  const int n = steps(reach, kGroundSquare);
  for (int dy = -n; dy <= n; ++dy)
    for (int dx = -n; dx <= n; ++dx) visit(Square{center.first + dx, center.second + dy});
}

// The squares beside the way that lie as deep below the sensor as most of them do: what carries the vehicle is ground.
std::vector<Square> beside_the_way(const std::map<Square, double>& lows, const std::vector<Eigen::Vector3d>& way) {
  std::vector<std::pair<Square, double>> beside;
  std::vector<double> depths;
  for (const Eigen::Vector3d& x : way)
    for_squares_around({steps(x.x(), kGroundSquare), steps(x.y(), kGroundSquare)}, kLaneHalfWidthM, [&](const Square& square) {
      if (const auto found = lows.find(square); found != lows.end()) {
        beside.emplace_back(square, x.z() - found->second);
        depths.push_back(beside.back().second);
      }
    });
  const double usual = median(depths);
  std::vector<Square> ground;
  for (const auto& [square, depth] : beside)
    if (std::abs(depth - usual) < kObstacle) ground.push_back(square);
  return ground;
}

// A step of so many squares.
struct Offset {
  double length;
  Square by;
};

// The steps within reach, the shortest first.
std::vector<Offset> offsets() {
  std::vector<Offset> out;
  for_squares_around({0, 0}, kReach, [&](const Square& by) { out.push_back({distance({0, 0}, by), by}); });
  std::sort(out.begin(), out.end(),
            [](const Offset& a, const Offset& b) { return std::tie(a.length, a.by) < std::tie(b.length, b.by); });
  return out;
}

// A way from a square that is ground to one that may be.
struct Hop {
  double length;
  Square to, from;
  std::size_t offset;  // its number in offsets()
  bool operator>(const Hop& other) const { return std::tie(length, to, from) > std::tie(other.length, other.to, other.from); }
};

double rise_within(double length) { return std::min(kMaxCurbM + kMaxSlope * length, kRise); }

// What rises no steeper than a bank from all ground nearby is ground, and falls no steeper. The other squares have returns of
// what stands on it only, or of mirrors and second echoes below it: the ground goes on there as it is nearby. Squares without
// ground within reach keep their lowest level.
class Growth {
 public:
  explicit Growth(std::map<Square, double> lows) : lows_(std::move(lows)) {}

  std::map<Square, double> from(const std::vector<Square>& start) {
    for (const Square& square : start) accept(square);
    while (!hops_.empty()) {
      const Hop shortest = hops_.top();
      hops_.pop();  // first: taking it adds others, shorter ones too
      push(shortest.from, shortest.offset + 1);
      take(shortest);
    }
    for (const auto& [square, height] : nearby_) lows_[square] = height;
    return std::move(lows_);
  }

 private:
  void accept(const Square& square) {
    if (ground_.emplace(square, true).second) push(square, 0);
  }
  // The shortest hop from a square that is ground, from that offset on: only one of each square waits, for the ground of a long
  // drive has two hundred times as many.
  void push(const Square& from, std::size_t offset) {
    for (; offset < offsets_.size(); ++offset) {
      const Square to{from.first + offsets_[offset].by.first, from.second + offsets_[offset].by.second};
      if (!lows_.contains(to) || ground_.contains(to)) continue;
      hops_.push({offsets_[offset].length, to, from, offset});
      return;
    }
  }
  void take(const Hop& hop) {
    if (ground_.contains(hop.to)) return;
    if (lows_.at(hop.from) - lows_.at(hop.to) <= rise_within(hop.length) && !rises(hop.to)) {
      nearby_.erase(hop.to);
      accept(hop.to);
      return;
    }
    nearby_.emplace(hop.to, lows_.at(hop.from));
    if (hop.length < 1.5 * kGroundSquare) ground_.emplace(hop.to, false);
  }
  // Steeper than a bank, from any ground around.
  bool rises(const Square& square) const {
    bool rises = false;
    for_squares_around(square, kAround, [&](const Square& other) {
      const auto found = ground_.find(other);
      rises |=
          found != ground_.end() && found->second && lows_.at(square) > lows_.at(other) + rise_within(distance(square, other));
    });
    return rises;
  }

  const std::vector<Offset> offsets_ = offsets();
  std::map<Square, double> lows_;
  std::map<Square, bool> ground_;    // of the squares that are decided
  std::map<Square, double> nearby_;  // of squares that are not ground so far, the height of the nearest that is
  std::priority_queue<Hop, std::vector<Hop>, std::greater<>> hops_;
};

}  // namespace

ScanGround::ScanGround(const Drive& drive, const Trajectory& world_from_lidar) {
  std::map<Square, Heaps> squares;
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
  std::vector<Eigen::Vector3d> way;
  for (const ScanHeader& header : drive.scan_headers)
    if (const auto pose = world_from_lidar.at(header.time_ns)) way.push_back(pose->t);
  const std::vector<Square> start = beside_the_way(lows, way);
  heights_ = Growth(std::move(lows)).from(start);
}

std::optional<double> ScanGround::height(const Eigen::Vector2d& place) const {
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

std::optional<double> ScanGround::nearest(int x, int y) const {
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

}  // namespace dvi::ground
