#include "dvi/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "dvi/registration/find_place.h"
#include "dvi/registration/tie_scans.h"
#include "dvi/scan_match/pose_graph.h"

namespace dvi::registration {
namespace {

using scan_match::PoseEdge;

// Standard deviations in meters and radians.
constexpr double kStep = 0.01, kStepTurn = 0.0005;  // of a trajectory from one key scan to the next
constexpr double kHeld = 1e-5;                      // of one that stays as it is
constexpr double kTie = 0.02, kTieTurn = 0.001;     // of a tie, on top of registration's own
constexpr double kKept = 0.25;                      // weight of a tie that the graph believes
constexpr std::size_t kFewestTies = 3;
constexpr double kInflation = 1;  // of standard deviations: errors of ties that share a local map are alike

Matrix6d information_of(double meters, double radians) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(meters * meters), Eigen::Vector3d::Constant(radians * radians);
  return variance.cwiseInverse().asDiagonal();
}

Matrix6d no_better_than(const Matrix6d& information, double meters, double radians) {
  return (information.inverse() + Matrix6d(information_of(meters, radians).inverse())).inverse();
}

/// A trajectory of which the poses at some times have moved, and those between with them.
Trajectory bent(const Trajectory& trajectory, const KeyScans& keys, const SE3* moved) {
  const auto time = [&](std::size_t k) { return keys.drive().scan_headers[keys[k].scan].time_ns; };
  const auto change = [&](std::size_t k) { return moved[k] * keys[k].world_from_lidar.inverse(); };
  std::vector<StampedPose> poses = trajectory.poses();
  std::size_t k = 0;
  for (StampedPose& p : poses) {
    while (k + 2 < keys.size() && time(k + 1) <= p.time_ns) ++k;
    SE3 by = change(k);
    if (k + 1 < keys.size()) {
      const double u = static_cast<double>(p.time_ns - time(k)) / static_cast<double>(time(k + 1) - time(k));
      by = interpolate(by, change(k + 1), std::clamp(u, 0.0, 1.0));
    }
    p.world_from_body = by * p.world_from_body;
  }
  Trajectory out(std::move(poses));
  out.max_extrapolation = trajectory.max_extrapolation;
  out.max_gap = trajectory.max_gap;
  return out;
}

/// The rigid motion that takes key scans from where they were to where they are, on the whole.
SE3 motion_between(const KeyScans& keys, const SE3* moved, const std::vector<std::size_t>& which) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  for (const std::size_t k : which) {
    turn += moved[k].R * keys[k].world_from_lidar.R.transpose();
    from += keys[k].world_from_lidar.t / static_cast<double>(which.size());
    to += moved[k].t / static_cast<double>(which.size());
  }
  const Eigen::Matrix3d R = nearest_rotation(turn);
  return {R, to - R * from};
}

class Registrar {
 public:
  Registrar(const DriveTrack& target, const std::vector<DriveTrack>& sources, const scan_match::MatchOptions& options,
            bool hold_target)
      : target_(target), sources_(sources), options_(options), hold_target_(hold_target) {
    out_.sources.resize(sources.size());
    placed_.push_back({0, {}, target.world_from_lidar, KeyScans(*target.drive, options, target.world_from_lidar), {}});
  }

  Registered operator()(const BeginPart& begin) {
    out_.target = target_.world_from_lidar;
    std::vector<bool> done(sources_.size(), false);
    // Who overlaps with a source drive only is placed once that has its place.
    for (bool progress = true; progress;) {
      progress = false;
      for (std::size_t i = 0; i < sources_.size(); ++i)
        if (!done[i] && place(i, begin)) done[i] = progress = true;
    }
    return std::move(out_);
  }

 private:
  struct Placed {
    std::size_t drive = 0;        // 0 the target, then sources
    SE3 world_from_source;        // where it was put first
    Trajectory world_from_lidar;  // before bending, in the target's world
    KeyScans keys;                // likewise
    std::vector<Tie> ties;        // to drives placed before; Tie::drive counts among the placed
  };

  bool place(std::size_t i, const BeginPart& begin) {
    const DriveTrack& source = sources_[i];
    const KeyScans keys(*source.drive, options_, source.world_from_lidar);
    const Tick tick = begin("register", keys.size());
    if (keys.size() < 2) return false;
    const auto [place, in] = best_place(keys, source.shares_world);
    if (!place) return false;
    PlacementFigures& out = out_.sources[i].figures;
    out.things = place->things.all();
    out.things_agree = place->things.confirmed;
    out.rival = place->rival;
    out.passed_share = place->passed_share;
    if (!place->sure()) return false;
    const SE3 world_from_b = placed_[in].keys[place->a].world_from_lidar * place->a_from_b;
    const SE3 world_from_source = world_from_b * keys[place->b].world_from_lidar.inverse();
    Placed now{i + 1, world_from_source, source.world_from_lidar.in(world_from_source), keys.in(world_from_source), {}};
    PlacedKeys others;
    for (const Placed& p : placed_) others.push_back(&p.keys);
    now.ties = tie_scans(others, now.keys, place->b, world_from_b, tick);
    if (now.ties.size() < kFewestTies) {
      out.overlap = static_cast<double>(now.ties.size()) / static_cast<double>(keys.size());
      return false;
    }
    placed_.push_back(std::move(now));
    solve();
    return true;
  }

  /// Among all drives that have their place; where a drive shares the target's world, there first.
  std::pair<std::optional<PlaceMatch>, std::size_t> best_place(const KeyScans& keys, bool shares_world) const {
    std::optional<PlaceMatch> best;
    std::size_t in = 0;
    for (const bool guess : {true, false})
      for (std::size_t p = 0; p < placed_.size(); ++p) {
        if (guess && !shares_world) continue;
        const std::optional<PlaceMatch> found =
            PlaceFinder(placed_[p].keys, keys).find(guess ? std::optional(SE3()) : std::nullopt);
        if (found && (!best || found->strength() > best->strength())) best = found, in = p;
        if (best && best->sure()) return {best, in};
      }
    return {best, in};
  }

  /// One pose graph over all drives that have their place, from where they were put first.
  void solve() {
    std::vector<SE3> poses;
    std::vector<std::size_t> first;  // node of each drive
    std::vector<scan_match::PoseEdge> edges;
    for (const Placed& p : placed_) {
      first.push_back(poses.size());
      const bool held = p.drive == 0 && hold_target_;
      for (std::size_t k = 0; k < p.keys.size(); ++k) {
        poses.push_back(p.keys[k].world_from_lidar);
        if (k == 0) continue;
        const std::size_t b = poses.size() - 1;
        edges.push_back({b - 1, b, poses[b - 1].inverse() * poses[b],
                         held ? information_of(kHeld, kHeld) : information_of(kStep, kStepTurn)});
      }
    }
    const std::size_t steps = edges.size();
    for (std::size_t p = 0; p < placed_.size(); ++p)
      for (const Tie& tie : placed_[p].ties)
        edges.push_back(
            {first[tie.drive] + tie.a, first[p] + tie.b, tie.a_from_b, no_better_than(tie.information, kTie, kTieTurn), true});
    const std::vector<double> weights = scan_match::solve_pose_graph(poses, edges);
    out_.target = bent(placed_[0].world_from_lidar, placed_[0].keys, poses.data());
    std::size_t next = steps;
    for (std::size_t p = 0; p < placed_.size(); next += placed_[p].ties.size(), ++p)
      if (p > 0) report(placed_[p], poses, edges, weights, first, next, p);
  }

  void report(const Placed& placed, const std::vector<SE3>& poses, const std::vector<scan_match::PoseEdge>& edges,
              const std::vector<double>& weights, const std::vector<std::size_t>& first, std::size_t first_tie, std::size_t p) {
    PlacementFigures& out = out_.sources[placed.drive - 1].figures;
    std::vector<std::size_t> tied, edge;
    double squares = 0;
    for (std::size_t k = 0; k < placed.ties.size(); ++k) {
      if (weights[first_tie + k] < kKept) continue;
      tied.push_back(placed.ties[k].b);
      edge.push_back(first_tie + k);
      squares += placed.ties[k].residual_m * placed.ties[k].residual_m;
    }
    const SE3* moved = poses.data() + first[p];
    out_.sources[placed.drive - 1].world_from_lidar = bent(placed.world_from_lidar, placed.keys, moved);
    out.overlap = static_cast<double>(tied.size()) / static_cast<double>(placed.keys.size());
    if (tied.empty()) return;
    out.residual_m = std::sqrt(squares / static_cast<double>(tied.size()));
    out.target_from_source = motion_between(placed.keys, moved, tied) * placed.world_from_source;
    const scan_match::PoseEdge& middle = edges[edge[edge.size() / 2]];
    const Matrix6d covariance = scan_match::compute_relative_covariance(poses, edges, weights, middle.a, middle.b);
    const auto bound = [&](int at) {  // of the length of an error in three dimensions: chi-squared
      const Eigen::Matrix3d part = covariance.block<3, 3>(at, at);
      return kInflation * std::sqrt(7.81 * Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(part).eigenvalues().maxCoeff());
    };
    out.bound_m = bound(0);
    out.bound_deg = bound(3) * 180 / std::numbers::pi;
  }

  const DriveTrack& target_;
  const std::vector<DriveTrack>& sources_;
  const scan_match::MatchOptions options_;
  const bool hold_target_;
  std::vector<Placed> placed_;
  Registered out_;
};

}  // namespace

Registered register_drives(const DriveTrack& target, const std::vector<DriveTrack>& sources,
                           const scan_match::MatchOptions& options, bool hold_target, const BeginPart& begin) {
  return Registrar(target, sources, options, hold_target)(begin);
}

}  // namespace dvi::registration
