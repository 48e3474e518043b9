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

constexpr double kGroundSquareM = kScanGround.square_m;

// One return, in its square and level.
struct LevelReturn {
  int x, y, step;
  double z;
};

struct LevelSum {
  int count = 0;
  double sum = 0;
};

// By level. A flat map saves memory: a square at a wall has a hundred levels, and a drive has a hundred thousand squares.
using LevelSums = boost::container::flat_map<int, LevelSum>;

int to_step(double v, double size) { return static_cast<int>(std::floor(v / size)); }

std::vector<LevelReturn> bin_returns(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar) {
  std::vector<LevelReturn> levels;
  const std::vector<Eigen::Vector3d> world = to_world(scan, header, world_from_lidar, kScanGround.point_step);
  for (std::size_t i = 0; i < world.size(); i += kScanGround.point_step) {
    const Eigen::Vector3d& x = world[i];
    if (scan.points[i].norm() > kScanGround.max_range_m) continue;
    levels.push_back(
        {to_step(x.x(), kGroundSquareM), to_step(x.y(), kGroundSquareM), to_step(x.z(), kScanGround.level_m), x.z()});
  }
  return levels;
}

/// Returns the mean of the lowest two adjacent levels that have more returns than errors explain.
std::optional<double> find_lowest_level(const LevelSums& levels_of_square) {
  int all = 0;
  for (const auto& [step, level_sum] : levels_of_square) all += level_sum.count;
  for (const auto& [step, level_sum] : levels_of_square) {
    LevelSum here = level_sum;
    if (const auto above = levels_of_square.find(step + 1); above != levels_of_square.end())
      here = {here.count + above->second.count, here.sum + above->second.sum};
    if (here.count > kScanGround.max_error_returns && here.count > kScanGround.max_error_share * all)
      return here.sum / here.count;
  }
  return std::nullopt;
}

using Square = std::pair<int, int>;

double distance(const Square& a, const Square& b) {
  return kGroundSquareM * std::hypot(a.first - b.first, a.second - b.second);
}

template <class Visit>
void for_squares_around(const Square& center, double distance_m, const Visit& visit) {
  const int n = to_step(distance_m, kGroundSquareM);
  for (int dy = -n; dy <= n; ++dy)
    for (int dx = -n; dx <= n; ++dx) visit(Square{center.first + dx, center.second + dy});
}

/// Selects the squares beside the path whose depth below the sensor is close to the median: they are ground.
std::vector<Square> select_lane_squares(const std::map<Square, double>& lows, const std::vector<Eigen::Vector3d>& path) {
  std::vector<std::pair<Square, double>> beside;
  std::vector<double> depths;
  for (const Eigen::Vector3d& x : path)
    for_squares_around({to_step(x.x(), kGroundSquareM), to_step(x.y(), kGroundSquareM)}, kScanGround.lane_half_width_m,
                       [&](const Square& square) {
                         if (const auto found = lows.find(square); found != lows.end()) {
                           beside.emplace_back(square, x.z() - found->second);
                           depths.push_back(beside.back().second);
                         }
                       });
  const double median_depth = median(depths);
  std::vector<Square> ground;
  for (const auto& [square, depth] : beside)
    if (std::abs(depth - median_depth) < kScanGround.max_obstacle_m) ground.push_back(square);
  return ground;
}

// The offset from one square to another.
struct Offset {
  double length;
  Square by;
};

/// Lists the offsets up to the largest gap, the shortest first.
std::vector<Offset> list_offsets() {
  std::vector<Offset> out;
  for_squares_around({0, 0}, kScanGround.max_gap_m, [&](const Square& by) { out.push_back({distance({0, 0}, by), by}); });
  std::sort(out.begin(), out.end(),
            [](const Offset& a, const Offset& b) { return std::tie(a.length, a.by) < std::tie(b.length, b.by); });
  return out;
}

// A step from a ground square to a square that may be ground.
struct Hop {
  double length;
  Square to, from;
  std::size_t offset;  // index in list_offsets()
  bool operator>(const Hop& other) const { return std::tie(length, to, from) > std::tie(other.length, other.to, other.from); }
};

double max_rise_m(double length) {
  return std::min(kScanGround.max_curb_m + kScanGround.max_slope * length, kScanGround.max_rise_m);
}

/// Grows the ground from the lane. A square is ground if it neither rises nor falls more steeply than a bank from the ground
/// around it. The other squares only have returns from objects, or from mirrors and second echoes below the ground: they get
/// the height of the nearest ground. Squares without ground within the largest gap keep their lowest level.
class GroundGrowth {
 public:
  explicit GroundGrowth(std::map<Square, double> lows) : lows_(std::move(lows)) {}

  std::map<Square, double> grow(const std::vector<Square>& start) {
    for (const Square& square : start) accept(square);
    while (!hops_.empty()) {
      const Hop shortest = hops_.top();
      hops_.pop();  // before try_hop(), which adds hops, some of them shorter
      push(shortest.from, shortest.offset + 1);
      try_hop(shortest);
    }
    for (const auto& [square, height] : nearby_) lows_[square] = height;
    return std::move(lows_);
  }

 private:
  void accept(const Square& square) {
    if (ground_.emplace(square, true).second) push(square, 0);
  }
  // Adds the shortest hop from a ground square, from that offset on. Only one hop per square is in the queue, because a long
  // drive has two hundred times as many hops.
  void push(const Square& from, std::size_t offset) {
    for (; offset < offsets_.size(); ++offset) {
      const Square to{from.first + offsets_[offset].by.first, from.second + offsets_[offset].by.second};
      if (!lows_.contains(to) || ground_.contains(to)) continue;
      hops_.push({offsets_[offset].length, to, from, offset});
      return;
    }
  }
  void try_hop(const Hop& hop) {
    if (ground_.contains(hop.to)) return;
    if (lows_.at(hop.from) - lows_.at(hop.to) <= max_rise_m(hop.length) && !is_raised(hop.to)) {
      nearby_.erase(hop.to);
      accept(hop.to);
      return;
    }
    nearby_.emplace(hop.to, lows_.at(hop.from));
    if (hop.length < 1.5 * kGroundSquareM) ground_.emplace(hop.to, false);
  }
  // Returns whether a square rises more steeply than a bank from any ground around it.
  bool is_raised(const Square& square) const {
    bool is_raised = false;
    for_squares_around(square, kScanGround.max_bank_m, [&](const Square& other) {
      const auto found = ground_.find(other);
      is_raised |=
          found != ground_.end() && found->second && lows_.at(square) > lows_.at(other) + max_rise_m(distance(square, other));
    });
    return is_raised;
  }

  const std::vector<Offset> offsets_ = list_offsets();
  std::map<Square, double> lows_;
  std::map<Square, bool> ground_;    // whether a decided square is ground
  std::map<Square, double> nearby_;  // for squares that are not ground so far: the height of the nearest ground
  std::priority_queue<Hop, std::vector<Hop>, std::greater<>> hops_;
};

}  // namespace

ScanGround::ScanGround(const Drive& drive, const Trajectory& world_from_lidar) {
  std::map<Square, LevelSums> squares;
  make_and_use(
      drive.scan_headers.size(),
      [&](std::size_t i) { return bin_returns(*drive.scans[i], drive.scan_headers[i], world_from_lidar); },
      [&](std::size_t, const std::vector<LevelReturn>& scan) {
        for (const LevelReturn& level : scan) {
          LevelSum& level_sum = squares[{level.x, level.y}][level.step];
          ++level_sum.count;
          level_sum.sum += level.z;
        }
      });
  std::map<Square, double> lows;
  for (const auto& [square, levels_of_square] : squares)
    if (const auto height = find_lowest_level(levels_of_square)) lows.emplace(square, *height);
  std::vector<Eigen::Vector3d> path;
  for (const ScanHeader& header : drive.scan_headers)
    if (const auto pose = world_from_lidar.at(header.time_ns)) path.push_back(pose->t);
  const std::vector<Square> start = select_lane_squares(lows, path);
  heights_ = GroundGrowth(std::move(lows)).grow(start);
}

ScanGround::ScanGround(const std::vector<GroundSquare>& squares) {
  for (const GroundSquare& square : squares) heights_.emplace(Square{square.x, square.y}, square.height_m);
}

std::vector<GroundSquare> ScanGround::squares() const {
  std::vector<GroundSquare> squares;
  for (const auto& [square, height] : heights_) squares.push_back({square.first, square.second, height});
  return squares;
}

std::optional<double> ScanGround::height(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d at =
      position / kGroundSquareM - Eigen::Vector2d::Constant(0.5);  // the height of a square is that at its center
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
  return find_nearest(to_step(position.x(), kGroundSquareM), to_step(position.y(), kGroundSquareM));
}

std::optional<double> ScanGround::find_nearest(int x, int y) const {
  for (int distance = 1; distance <= 2; ++distance) {
    std::optional<double> low;
    for (int dy = -distance; dy <= distance; ++dy)
      for (int dx = -distance; dx <= distance; ++dx) {
        const auto found = heights_.find({x + dx, y + dy});
        if (found != heights_.end() && (!low || found->second < *low)) low = found->second;
      }
    if (low) return low;
  }
  return std::nullopt;
}

}  // namespace dvi::ground
