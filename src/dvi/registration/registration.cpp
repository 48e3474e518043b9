#include "dvi/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "dvi/geometry/angles.h"
#include "dvi/geometry/information.h"
#include "dvi/registration/find_place.h"
#include "dvi/registration/scan_constraints.h"
#include "dvi/scan_match/pose_graph.h"

namespace dvi::registration {
namespace {

using scan_match::PoseEdge;

/// Chi-squared with three degrees of freedom at 95 %: squared length of an error in three dimensions.
constexpr double kChiSquared95 = 7.81;

/// Deforms a trajectory so that its key scans get the given poses; the changes between key scans are interpolated.
Trajectory deform(const Trajectory& trajectory, const KeyScans& keys, const SE3* new_poses) {
  const auto time = [&](std::size_t k) { return keys.drive().scan_headers[keys[k].scan].time_ns; };
  const auto change = [&](std::size_t k) { return new_poses[k] * keys[k].world_from_lidar.inverse(); };
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

/// The mean rigid motion from the old to the new poses of the given key scans.
SE3 estimate_motion(const KeyScans& keys, const SE3* new_poses, const std::vector<std::size_t>& which) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  for (const std::size_t k : which) {
    rotation += new_poses[k].R * keys[k].world_from_lidar.R.transpose();
    from += keys[k].world_from_lidar.t / static_cast<double>(which.size());
    to += new_poses[k].t / static_cast<double>(which.size());
  }
  const Eigen::Matrix3d R = nearest_rotation(rotation);
  return {R, to - R * from};
}

class DriveRegistration {
 public:
  DriveRegistration(const DriveTrack& target, const std::vector<DriveTrack>& sources, const scan_match::MatchOptions& options)
      : target_(target), sources_(sources), options_(options) {
    out_.sources.resize(sources.size());
    placed_.push_back({0, {}, target.world_from_lidar, KeyScans(*target.drive, options, target.world_from_lidar), {}});
  }

  Registered run(const BeginPart& begin) {
    out_.target = target_.world_from_lidar;
    std::vector<bool> done(sources_.size(), false);
    // A drive that overlaps only with another source drive can be placed after that one.
    for (bool progress = true; progress;) {
      progress = false;
      for (std::size_t i = 0; i < sources_.size(); ++i)
        if (!done[i] && place(i, begin)) done[i] = progress = true;
    }
    return std::move(out_);
  }

 private:
  struct Placed {
    std::size_t drive = 0;                    // 0 is the target, then the sources
    SE3 world_from_source;                    // the initial placement
    Trajectory world_from_lidar;              // in the target's world, before it is deformed
    KeyScans keys;                            // likewise
    std::vector<ScanConstraint> constraints;  // ScanConstraint::drive is an index in placed_
  };

  bool place(std::size_t i, const BeginPart& begin) {
    const DriveTrack& source = sources_[i];
    const KeyScans keys(*source.drive, options_, source.world_from_lidar);
    const Tick tick = begin("register", keys.size());
    if (keys.size() < 2) return false;
    const auto [place, in] = find_best_place(keys, source.shares_world);
    if (!place) return false;
    PlacementFigures& out = out_.sources[i].figures;
    out.landmarks = place->landmarks.total();
    out.landmark_inliers = place->landmarks.inliers;
    out.second_best_ratio = place->second_best_ratio;
    out.passed_share = place->passed_share;
    if (!place->is_certain()) return false;
    const SE3 world_from_b = placed_[in].keys[place->a].world_from_lidar * place->a_from_b;
    const SE3 world_from_source = world_from_b * keys[place->b].world_from_lidar.inverse();
    Placed now{i + 1, world_from_source, source.world_from_lidar.in(world_from_source), keys.transform(world_from_source), {}};
    PlacedKeys others;
    for (const Placed& p : placed_) others.push_back(&p.keys);
    now.constraints = find_scan_constraints(others, now.keys, {place->b, world_from_b}, tick);
    if (now.constraints.size() < kDriveGraph.min_constraints) {
      out.overlap = static_cast<double>(now.constraints.size()) / static_cast<double>(keys.size());
      return false;
    }
    placed_.push_back(std::move(now));
    solve();
    return true;
  }

  /// Searches all placed drives and returns the best place with the index of its drive. If the drive shares the target's world,
  /// its own poses are tried first.
  std::pair<std::optional<PlaceMatch>, std::size_t> find_best_place(const KeyScans& keys, bool shares_world) const {
    std::optional<PlaceMatch> best;
    std::size_t in = 0;
    for (const bool use_guess : {true, false})
      for (std::size_t p = 0; p < placed_.size(); ++p) {
        if (use_guess && !shares_world) continue;
        const std::optional<PlaceMatch> found =
            PlaceFinder(placed_[p].keys, keys).find(use_guess ? std::optional(SE3()) : std::nullopt);
        if (found && (!best || found->score() > best->score())) best = found, in = p;
        if (best && best->is_certain()) return {best, in};
      }
    return {best, in};
  }

  /// Solves one pose graph over all placed drives, starting from their initial placements.
  void solve() {
    scan_match::PoseGraph graph;
    auto& [poses, edges, weights] = graph;
    std::vector<std::size_t> first;  // node of each drive
    for (const Placed& p : placed_) {
      first.push_back(poses.size());
      const bool is_fixed = p.drive == 0 && target_.is_fixed;
      for (std::size_t k = 0; k < p.keys.size(); ++k) {
        poses.push_back(p.keys[k].world_from_lidar);
        if (k == 0) continue;
        const std::size_t b = poses.size() - 1;
        edges.push_back({b - 1, b, poses[b - 1].inverse() * poses[b],
                         is_fixed ? to_information(kDriveGraph.fixed_sigma, kDriveGraph.fixed_sigma)
                                  : to_information(kDriveGraph.step_sigma_m, kDriveGraph.step_sigma_rad)});
      }
    }
    const std::size_t steps = edges.size();
    for (std::size_t p = 0; p < placed_.size(); ++p)
      for (const ScanConstraint& c : placed_[p].constraints)
        edges.push_back({first[c.drive] + c.a, first[p] + c.b, c.a_from_b,
                         add_errors(c.information, kDriveGraph.constraint_sigma_m, kDriveGraph.constraint_sigma_rad), true});
    weights = scan_match::solve_pose_graph(poses, edges);
    out_.target = deform(placed_[0].world_from_lidar, placed_[0].keys, poses.data());
    std::size_t next = steps;
    for (std::size_t p = 0; p < placed_.size(); next += placed_[p].constraints.size(), ++p)
      if (p > 0) report(placed_[p], graph, first[p], next);
  }

  /// Reports a source drive, whose nodes and constraints in the graph begin at these indices.
  void report(const Placed& placed, const scan_match::PoseGraph& graph, std::size_t first_node, std::size_t first_constraint) {
    PlacementFigures& out = out_.sources[placed.drive - 1].figures;
    std::vector<std::size_t> inliers, edge;
    double squares = 0;
    for (std::size_t k = 0; k < placed.constraints.size(); ++k) {
      if (graph.weights[first_constraint + k] < kDriveGraph.min_inlier_weight) continue;
      inliers.push_back(placed.constraints[k].b);
      edge.push_back(first_constraint + k);
      squares += placed.constraints[k].residual_m * placed.constraints[k].residual_m;
    }
    const SE3* new_poses = graph.world_from_body.data() + first_node;
    out_.sources[placed.drive - 1].world_from_lidar = deform(placed.world_from_lidar, placed.keys, new_poses);
    out.overlap = static_cast<double>(inliers.size()) / static_cast<double>(placed.keys.size());
    if (inliers.empty()) return;
    out.residual_m = std::sqrt(squares / static_cast<double>(inliers.size()));
    out.target_from_source = estimate_motion(placed.keys, new_poses, inliers) * placed.world_from_source;
    const scan_match::PoseEdge& middle = graph.edges[edge[edge.size() / 2]];
    const Matrix6d covariance = scan_match::compute_relative_covariance(graph, middle.a, middle.b);
    const auto bound = [&](int at) {
      const Eigen::Matrix3d part = covariance.block<3, 3>(at, at);
      return std::sqrt(kChiSquared95 * Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(part).eigenvalues().maxCoeff());
    };
    out.bound_m = bound(0);
    out.bound_deg = to_degrees(bound(3));
  }

  const DriveTrack& target_;
  const std::vector<DriveTrack>& sources_;
  const scan_match::MatchOptions options_;
  std::vector<Placed> placed_;
  Registered out_;
};

}  // namespace

Registered register_drives(const DriveTrack& target, const std::vector<DriveTrack>& sources,
                           const scan_match::MatchOptions& options, const BeginPart& begin) {
  return DriveRegistration(target, sources, options).run(begin);
}

}  // namespace dvi::registration
