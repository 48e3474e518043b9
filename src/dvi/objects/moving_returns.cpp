#include "dvi/objects/moving_returns.h"

#include <algorithm>
#include <optional>

#include "dvi/drive/deskew.h"

namespace dvi::objects {
namespace {

constexpr double kLowest = 0.3, kHighest = 4.5;     // meters above ground: curbs and grass; trucks and buses
constexpr double kRadius = 0.05;                    // meters round a return that must have been free
constexpr std::size_t kNear = 10;                   // scans before and after
constexpr std::size_t kFarStep = 4, kMostFar = 20;  // of the scans of the whole drive, each fourth, or fewer, so many at most
constexpr double kFarReach = 60;                    // meters between sensors
constexpr double kSamePlaceM = 0.2;                 // between sensors
constexpr int kFewestPasses = 2;                    // scans that must have seen through
constexpr double kPassedShare = 0.6;                // of the scans that can tell: edges and glass are passed now and then

}  // namespace

// Scans that were taken from one place have one view of a return, so they count as one scan: by their mean. Only those from the
// place of the return's own scan, which observe it as that scan does, can show on their own that it moves.
class Votes {
 public:
  void add(FreeSpace::Seen seen) {
    here_passed_ += seen == FreeSpace::Seen::passed;
    here_hit_ += seen == FreeSpace::Seen::hit;
  }
  void finish_place(bool own) {
    if (here_passed_ + here_hit_ > 0) {
      ++places_;
      passed_share_ += static_cast<double>(here_passed_) / (here_passed_ + here_hit_);
    }
    passed_ += own ? here_passed_ : std::min(here_passed_, 1);
    hit_ += here_hit_;
    here_passed_ = here_hit_ = 0;
  }
  int hit() const { return hit_; }
  bool moving() const { return passed_ >= kFewestPasses && passed_share_ >= kPassedShare * places_; }

 private:
  int here_passed_ = 0, here_hit_ = 0, passed_ = 0, hit_ = 0, places_ = 0;
  double passed_share_ = 0;  // sum over the places
};

MovingReturns::MovingReturns(const Drive& drive, const ScanPoses& poses, const ground::ScanGround& ground)
    : drive_(drive),
      world_from_lidar_(poses.world_from_lidar),
      ground_(ground),
      spaces_(drive.scan_headers.size(),
              [this, error_m = poses.error_m](std::size_t i) {
                return FreeSpace(*drive_.scans[i], drive_.scan_headers[i], world_from_lidar_, error_m);
              }),
      obstacles_(drive.scan_headers.size(), [this](std::size_t i) { return obstacles_of(i); }),
      untrusted_(poses.untrusted) {
  untrusted_.resize(drive.scan_headers.size(), false);
  for (const ScanHeader& header : drive.scan_headers) {
    const auto pose = world_from_lidar_.at(header.time_ns);
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

bool MovingReturns::observes(std::size_t scan, const Eigen::Vector2d& place) const {
  return trusts(scan) && (sensors_[scan] - place).norm() < kFarReach;
}

std::shared_ptr<const ObstacleReturns> MovingReturns::obstacles(std::size_t scan) const {
  return trusts(scan) ? obstacles_[scan] : std::make_shared<const ObstacleReturns>();
}

ObstacleReturns MovingReturns::obstacles_of(std::size_t scan) const {
  ObstacleReturns out;
  const float rise = spaces_[scan]->rise();
  const auto returns = drive_.scans[scan];
  const ScanHeader& header = drive_.scan_headers[scan];
  const std::vector<Eigen::Vector3d> world = to_world(*returns, header, world_from_lidar_);
  for (std::size_t i = 0; i < world.size(); ++i) {
    const float range = returns->points[i].norm();
    if (range < 1 || range > FreeSpace::kMaxRangeM) continue;
    const auto ground = ground_.height(world[i].head<2>());
    if (!ground || world[i].z() < *ground + kLowest || world[i].z() > *ground + kHighest) continue;
    out.points.push_back(world[i]);
    out.time_ns.push_back(header.time_ns + std::llround(1e9 * static_cast<double>(returns->time[i])));
    out.ground.push_back(*ground);
    out.rise.push_back(static_cast<double>(rise * range));
  }
  return out;
}

std::vector<Votes> MovingReturns::votes_of(const std::vector<std::size_t>& scans, std::size_t judged,
                                           const std::vector<Eigen::Vector3d>& points) const {
  std::vector<Votes> votes(points.size());
  std::optional<Eigen::Vector2d> place;
  const auto finish_place = [&] {
    const bool own = place && (sensors_[judged] - *place).norm() < kSamePlaceM;
    for (Votes& of_point : votes) of_point.finish_place(own);
  };
  for (const std::size_t scan : scans) {
    if (!trusts(scan)) continue;
    const auto space = spaces_[scan];
    if (!space->valid()) continue;
    if (place && (sensors_[scan] - *place).norm() >= kSamePlaceM) finish_place();
    if (!place || (sensors_[scan] - *place).norm() >= kSamePlaceM) place = sensors_[scan];
    for (std::size_t i = 0; i < points.size(); ++i) votes[i].add(space->judge(points[i], kRadius));
  }
  finish_place();
  return votes;
}

ObstacleReturns MovingReturns::find(std::size_t scan) const {
  ObstacleReturns out = *obstacles(scan);
  std::vector<std::size_t> window;
  for (std::size_t other = scan - std::min(scan, kNear); other < std::min(scan + kNear + 1, sensors_.size()); ++other)
    if (other != scan) window.push_back(other);
  const std::vector<Votes> near = votes_of(window, scan, out.points), far = votes_of(witnesses_far(scan), scan, out.points);
  for (std::size_t i = 0; i < out.points.size(); ++i)
    out.witness.push_back(near[i].moving() || far[i].moving()             ? Witness::moving
                          : near[i].hit() + far[i].hit() >= kFewestPasses ? Witness::standing
                                                                          : Witness::unknown);
  return out;
}

}  // namespace dvi::objects
