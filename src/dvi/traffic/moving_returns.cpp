#include "dvi/traffic/moving_returns.h"

#include <algorithm>

#include "dvi/drive/deskew.h"

namespace dvi::traffic {
namespace {

constexpr double kLowest = 0.3, kHighest = 4.5;     // metres above ground: kerbs and grass; lorries and buses
constexpr double kRadius = 0.05;                    // metres round a return that must have been free
constexpr std::size_t kNear = 10;                   // scans before and after
constexpr std::size_t kFarStep = 4, kMostFar = 20;  // of the scans of the whole drive, each fourth, or fewer, so many at most
constexpr double kFarReach = 60;                    // metres between sensors
constexpr int kFewestPasses = 2;                    // scans that must have seen through
constexpr double kPassedShare = 0.6;                // of the scans that can tell: edges and glass are passed now and then

struct Votes {
  int passed = 0, hit = 0;

  void add(FreeSpace::Seen seen) {
    passed += seen == FreeSpace::Seen::passed;
    hit += seen == FreeSpace::Seen::hit;
  }
  bool moving() const { return passed >= kFewestPasses && passed >= kPassedShare * (passed + hit); }
};

}  // namespace

MovingReturns::MovingReturns(const Drive& drive, const Trajectory& world_from_lidar, const Ground& ground, double pose_error_m)
    : drive_(drive),
      world_from_lidar_(world_from_lidar),
      ground_(ground),
      spaces_(drive.scan_headers.size(), [&drive, world_from_lidar, pose_error_m](std::size_t i) {
        return FreeSpace(*drive.scans[i], drive.scan_headers[i], world_from_lidar, pose_error_m);
      }) {
  for (const ScanHeader& header : drive.scan_headers) {
    const auto pose = world_from_lidar.at(header.time_ns);
    sensors_.push_back(pose ? Eigen::Vector2d(pose->t.head<2>()) : Eigen::Vector2d::Constant(1e9));
  }
}

std::vector<std::size_t> MovingReturns::witnesses_far(std::size_t scan) const {
  const auto witnesses = [&](std::size_t step) {
    std::vector<std::size_t> far;
    for (std::size_t i = 0; i < sensors_.size(); i += step)
      if ((i + kNear < scan || i > scan + kNear) && (sensors_[i] - sensors_[scan]).norm() < kFarReach) far.push_back(i);
    return far;
  };
  std::size_t step = kFarStep;
  std::vector<std::size_t> far = witnesses(step);
  while (far.size() > kMostFar) far = witnesses(step *= 2);
  return far;
}

ObstacleReturns MovingReturns::obstacles(std::size_t scan) const {
  ObstacleReturns out;
  const float rise = spaces_[scan]->rise();
  const auto returns = drive_.scans[scan];
  const ScanHeader& header = drive_.scan_headers[scan];
  const std::vector<Eigen::Vector3d> world = to_world(*returns, header, world_from_lidar_);
  for (std::size_t i = 0; i < world.size(); ++i) {
    const float range = returns->points[i].norm();
    if (range < 1 || range > FreeSpace::kMaxRange) continue;
    const auto ground = ground_.height(world[i].head<2>());
    if (!ground || world[i].z() < *ground + kLowest || world[i].z() > *ground + kHighest) continue;
    out.points.push_back(world[i]);
    out.time_ns.push_back(header.time_ns + std::llround(1e9 * static_cast<double>(returns->time[i])));
    out.ground.push_back(*ground);
    out.rise.push_back(static_cast<double>(rise * range));
  }
  return out;
}

ObstacleReturns MovingReturns::find(std::size_t scan) const {
  ObstacleReturns out = obstacles(scan);
  std::vector<Votes> near(out.points.size()), far(out.points.size());
  const auto ask = [&](std::size_t other, std::vector<Votes>& votes) {
    const auto space = spaces_[other];
    if (!space->valid()) return;
    for (std::size_t i = 0; i < out.points.size(); ++i) votes[i].add(space->judge(out.points[i], kRadius));
  };
  const std::size_t first = scan - std::min(scan, kNear), last = std::min(scan + kNear + 1, sensors_.size());
  for (std::size_t other = first; other < last; ++other)
    if (other != scan) ask(other, near);
  for (const std::size_t other : witnesses_far(scan)) ask(other, far);
  for (std::size_t i = 0; i < out.points.size(); ++i)
    out.witness.push_back(near[i].moving() || far[i].moving()         ? Witness::moving
                          : near[i].hit + far[i].hit >= kFewestPasses ? Witness::standing
                                                                      : Witness::unknown);
  return out;
}

}  // namespace dvi::traffic
