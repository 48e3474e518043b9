#include "dvi/objects/moving_returns.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "dvi/core/lazy.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"

namespace dvi::objects {
namespace {

struct VisibilityVoteParams {
  double min_height_m = 0.3;           ///< above ground: excludes curbs and grass
  double max_height_m = 4.5;           ///< above ground: includes trucks and buses
  double min_range_m = 1;              ///< closer returns lie on the ego vehicle
  double return_radius_m = 0.05;       ///< radius around a return that must be free
  std::size_t window_scans = 10;       ///< scans before and after that are compared
  std::size_t distant_step = 4;        ///< step between the scans of the whole drive that are compared
  std::size_t max_distant_scans = 20;  ///< the step is doubled until at most so many scans remain
  double max_sensor_distance_m = 60;   ///< distance between the sensors of two scans that are compared
  double same_position_m = 0.2;        ///< distance between sensors up to which scans have the same view
  int min_free_scans = 2;              ///< scans that must observe free space at a moving return
  int min_hit_scans = 2;               ///< scans that must observe a surface at a stationary return
  double min_free_share = 0.6;         ///< share among the scans that observe the position: rays pass edges and glass at times
};
constexpr VisibilityVoteParams kVoting{};

// Whether the scans of a sensor position have the view of the scan that is judged.
enum class SensorPosition { own, other };

// Counts the votes of scans on one return. Scans from one sensor position have one view of the return, so they count as one
// scan, by their mean. Only scans from the position of the return's own scan, which observe the return as that scan does, can
// show on their own that it moves.
class VoteCounts {
 public:
  void add(FreeSpace::Seen state) {
    current_free_ += state == FreeSpace::Seen::passed;
    current_hit_ += state == FreeSpace::Seen::hit;
  }
  void finish_position(SensorPosition position) {
    if (current_free_ + current_hit_ > 0) {
      ++positions_;
      free_share_sum_ += static_cast<double>(current_free_) / (current_free_ + current_hit_);
    }
    free_ += position == SensorPosition::own ? current_free_ : std::min(current_free_, 1);
    hit_ += current_hit_;
    current_free_ = current_hit_ = 0;
  }
  int hit() const { return hit_; }
  bool is_moving() const { return free_ >= kVoting.min_free_scans && free_share_sum_ >= kVoting.min_free_share * positions_; }

 private:
  int current_free_ = 0, current_hit_ = 0, free_ = 0, hit_ = 0, positions_ = 0;
  double free_share_sum_ = 0;  // over the positions
};

}  // namespace

// A scan, and the observations of other scans at its returns.
struct ComparedScan {
  std::size_t number = 0;
  std::shared_ptr<const ObstacleReturns> returns;
  std::vector<std::size_t> window, distant;                      // the other scans; scans with wrong poses are left out
  std::map<std::size_t, std::vector<FreeSpace::Seen>> observed;  // by other scan: per return; empty if it observes nothing

  void compare(std::size_t other, const FreeSpace& space) {
    const auto found = observed.find(other);
    if (found == observed.end() || !space.valid()) return;
    found->second.reserve(returns->points.size());
    for (const Eigen::Vector3d& point : returns->points) found->second.push_back(space.judge(point, kVoting.return_radius_m));
  }

  std::vector<VoteCounts> count_votes(const std::vector<std::size_t>& others,
                                      const std::vector<Eigen::Vector2d>& sensors) const {
    std::vector<VoteCounts> votes(returns->points.size());
    std::optional<Eigen::Vector2d> position;
    const auto finish_position = [&] {
      const bool own = position && (sensors[number] - *position).norm() < kVoting.same_position_m;
      for (VoteCounts& counts : votes) counts.finish_position(own ? SensorPosition::own : SensorPosition::other);
    };
    for (const std::size_t other : others) {
      const std::vector<FreeSpace::Seen>& states = observed.at(other);
      if (states.empty()) continue;
      if (position && (sensors[other] - *position).norm() >= kVoting.same_position_m) finish_position();
      if (!position || (sensors[other] - *position).norm() >= kVoting.same_position_m) position = sensors[other];
      for (std::size_t i = 0; i < states.size(); ++i) votes[i].add(states[i]);
    }
    finish_position();
    return votes;
  }
};

MovingReturns::MovingReturns(const Drive& drive, const ScanPoses& poses, const ground::ScanGround& ground)
    : drive_(drive),
      world_from_lidar_(poses.world_from_lidar),
      ground_(ground),
      spaces_(drive.scan_headers.size(),
              [this, error_m = poses.error_m](std::size_t i) {
                return FreeSpace(*drive_.scans[i], drive_.scan_headers[i], world_from_lidar_, error_m);
              }),
      obstacles_(drive.scan_headers.size(), [this](std::size_t i) { return extract_obstacles(i); }),
      untrusted_(poses.untrusted) {
  untrusted_.resize(drive.scan_headers.size(), false);
  for (const ScanHeader& header : drive.scan_headers) {
    const auto pose = world_from_lidar_.at(header.time_ns);
    sensors_.push_back(pose ? Eigen::Vector2d(pose->t.head<2>()) : Eigen::Vector2d::Constant(1e9));
  }
}

std::vector<std::size_t> MovingReturns::select_window(std::size_t scan) const {
  std::vector<std::size_t> window;
  const std::size_t radius = kVoting.window_scans;
  for (std::size_t other = scan - std::min(scan, radius); other < std::min(scan + radius + 1, sensors_.size()); ++other)
    if (other != scan) window.push_back(other);
  return window;
}

std::vector<std::size_t> MovingReturns::select_distant(std::size_t scan) const {
  const auto select = [&](std::size_t step) {
    std::vector<std::size_t> distant;
    for (std::size_t i = 0; i < sensors_.size(); i += step)
      if ((i + kVoting.window_scans < scan || i > scan + kVoting.window_scans) &&
          (sensors_[i] - sensors_[scan]).norm() < kVoting.max_sensor_distance_m)
        distant.push_back(i);
    return distant;
  };
  std::size_t step = kVoting.distant_step;
  std::vector<std::size_t> distant = select(step);
  while (distant.size() > kVoting.max_distant_scans) distant = select(step *= 2);
  return distant;
}

std::optional<std::size_t> MovingReturns::find_scan(std::int64_t time_ns) const {
  const ScanHeader* const nearest = nearest_in_time(drive_.scan_headers, time_ns, kMaxFrameToScanNs);
  if (!nearest) return std::nullopt;
  return static_cast<std::size_t>(nearest - drive_.scan_headers.data());
}

bool MovingReturns::can_observe(std::size_t scan, const Eigen::Vector2d& position) const {
  return is_trusted(scan) && (sensors_[scan] - position).norm() < kVoting.max_sensor_distance_m;
}

Eigen::AlignedBox2d MovingReturns::observable_area(std::size_t scan) const {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(kVoting.max_sensor_distance_m);
  return {sensors_[scan] - reach, sensors_[scan] + reach};
}

std::shared_ptr<const ObstacleReturns> MovingReturns::obstacles(std::size_t scan) const {
  return is_trusted(scan) ? obstacles_[scan] : std::make_shared<const ObstacleReturns>();
}

ObstacleReturns MovingReturns::extract_obstacles(std::size_t scan) const {
  ObstacleReturns out;
  const float ray_spacing_rad = spaces_[scan]->rise();
  const auto returns = drive_.scans[scan];
  const ScanHeader& header = drive_.scan_headers[scan];
  const std::vector<Eigen::Vector3d> world = to_world(*returns, header, world_from_lidar_);
  const auto labels = drive_.point_labels.empty() ? nullptr : drive_.point_labels[scan];
  for (std::size_t i = 0; i < world.size(); ++i) {
    const float range = returns->points[i].norm();
    if (static_cast<double>(range) < kVoting.min_range_m || range > FreeSpace::kMaxRangeM) continue;
    const auto ground = ground_.height(world[i].head<2>());
    if (!ground || world[i].z() < *ground + kVoting.min_height_m || world[i].z() > *ground + kVoting.max_height_m) continue;
    out.points.push_back(world[i]);
    out.time_ns.push_back(header.time_ns + std::llround(1e9 * static_cast<double>(returns->time[i])));
    out.ground.push_back(*ground);
    out.ray_spacing_m.push_back(static_cast<double>(ray_spacing_rad * range));
    if (labels) out.label.push_back(labels->values[i]);
  }
  return out;
}

ComparedScan MovingReturns::list_comparisons(std::size_t scan) const {
  ComparedScan out{scan, obstacles(scan), select_window(scan), select_distant(scan), {}};
  for (std::vector<std::size_t>* others : {&out.window, &out.distant}) {
    std::erase_if(*others, [&](std::size_t other) { return !is_trusted(other); });
    for (const std::size_t other : *others) out.observed[other];
  }
  return out;
}

std::vector<ObstacleReturns> MovingReturns::vote(std::size_t first, std::size_t last) const {
  std::vector<ComparedScan> compared(last - first);
  parallel_for(compared.size(), [&](std::size_t k) { compared[k] = list_comparisons(first + k); });
  std::set<std::size_t> others;
  for (const ComparedScan& scan : compared)
    for (const auto& [other, states] : scan.observed) others.insert(other);
  const std::vector<std::size_t> numbers(others.begin(), others.end());
  for_each_item(spaces_, numbers, [&](std::size_t n, const std::shared_ptr<const FreeSpace>& space) {
    for (ComparedScan& scan : compared) scan.compare(numbers[n], *space);
  });
  std::vector<ObstacleReturns> out(compared.size());
  parallel_for(compared.size(), [&](std::size_t k) {
    const std::vector<VoteCounts> near = compared[k].count_votes(compared[k].window, sensors_),
                                  far = compared[k].count_votes(compared[k].distant, sensors_);
    out[k] = *compared[k].returns;
    for (std::size_t i = 0; i < near.size(); ++i)
      out[k].vote.push_back(near[i].is_moving() || far[i].is_moving()               ? VisibilityVote::moving
                            : near[i].hit() + far[i].hit() >= kVoting.min_hit_scans ? VisibilityVote::stationary
                                                                                    : VisibilityVote::unknown);
  });
  return out;
}

}  // namespace dvi::objects
