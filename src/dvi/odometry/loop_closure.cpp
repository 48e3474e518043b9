#include "dvi/odometry/loop_closure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/geometry/information.h"
#include "dvi/scan_match/pose_graph.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::odometry {

namespace {

/// Returns the parameters for the drive's sensor. A depth camera has a tenth of the range of a LiDAR, is tilted by the hand
/// that holds it, and has one viewing direction, so that views must overlap. Walls look alike in many rooms.
LoopParams get_params(const Drive& drive) {
  if (drive.sensor != Sensor::depth_camera) return {};
  return {.min_path_step_m = 0.05,
          .min_path_m = 3,
          .candidate_step_m = 0.5,
          .min_error_m = 0.3,
          .max_error_m = 0.75,
          .map_path_m = 0.6,
          .map_step_m = 0.12,
          .check_path_m = 0.3,
          .grid_step_m = 0.15,
          .is_level = false,
          .max_turn_rad = 0.4,
          .min_relative_share = 0.8};
}

/// The scans that have poses, in the order of the trajectory.
struct PosedScans {
  std::vector<std::size_t> scan_index;
  std::vector<SE3> pose;
  std::vector<Vector6d> twist;  // per second
  std::vector<double> path_m;   // path length from the first

  std::size_t size() const { return pose.size(); }
};

PosedScans list_posed_scans(const Odometry& odometry, const LoopParams& params) {
  PosedScans out;
  for (std::size_t i = 0; i < odometry.scans.size(); ++i) {
    const ScanFit::State state = odometry.scans[i].state;
    if (state != ScanFit::State::no_points && state != ScanFit::State::duplicate) out.scan_index.push_back(i);
  }
  const std::vector<StampedPose>& poses = odometry.world_from_lidar.poses();
  if (poses.size() != out.scan_index.size()) return {};  // a single scan has two poses
  std::size_t last = 0;
  double path_m = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    out.pose.push_back(poses[i].world_from_body);
    const StampedPose &a = poses[i > 0 ? i - 1 : 0], &b = poses[std::min(i + 1, poses.size() - 1)];
    const double seconds = 1e-9 * static_cast<double>(b.time_ns - a.time_ns);
    out.twist.push_back(seconds > 0 ? Vector6d(se3_log(a.world_from_body.inverse() * b.world_from_body) / seconds)
                                    : Vector6d(Vector6d::Zero()));
    // Steps below the threshold are noise of a stationary car.
    const double distance_m = (out.pose[i].t - out.pose[last].t).norm();
    if (distance_m > params.min_path_step_m) path_m += distance_m, last = i;
    out.path_m.push_back(path_m);
  }
  return out;
}

double predict_error_m(double path_m, const LoopParams& params) {
  return std::min(params.min_error_m + params.drift * path_m, params.max_error_m);
}

double compute_turn_rad(const SE3& a, const SE3& b) { return so3_log(a.R.transpose() * b.R).norm(); }

/// The poses with a long path between them and a current pose that advances, in a grid.
class EarlierPoses {
 public:
  EarlierPoses(const PosedScans& scans, const LoopParams& params) : scans_(scans), params_(params) {}

  /// Returns the pose nearest to pose i that has a similar direction and is within the possible error. `i` must not decrease.
  std::optional<std::size_t> find_nearest(std::size_t i) {
    for (; is_far_before(next_, i); ++next_) cells_[cell_of(next_)].push_back(next_);
    std::optional<std::size_t> out;
    double nearest = params_.max_error_m;
    const auto [x, y] = cell_of(i);
    for (const int column : {x - 1, x, x + 1})
      for (const int row : {y - 1, y, y + 1})
        if (const auto cell = cells_.find({column, row}); cell != cells_.end())
          for (const std::size_t k : cell->second) {
            const double distance = (scans_.pose[k].t - scans_.pose[i].t).norm();
            if (distance > nearest || distance >= predict_error_m(scans_.path_m[i] - scans_.path_m[k], params_)) continue;
            if (compute_turn_rad(scans_.pose[k], scans_.pose[i]) > params_.max_turn_rad) continue;
            if (distance < nearest || (out && k < *out)) out = k, nearest = distance;
          }
    return out;
  }

 private:
  bool is_far_before(std::size_t k, std::size_t i) const {
    return k < i && scans_.path_m[i] - scans_.path_m[k] > params_.min_path_m;
  }
  std::pair<int, int> cell_of(std::size_t i) const {
    const auto cell = [&](double meters) { return static_cast<int>(std::floor(meters / params_.max_error_m)); };
    return {cell(scans_.pose[i].t.x()), cell(scans_.pose[i].t.y())};
  }

  const PosedScans& scans_;
  const LoopParams& params_;
  std::size_t next_ = 0;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;  // edge: max_error_m
};

/// Removes roll, pitch, and height: a car that passes a place twice has the same attitude on the road.
SE3 level(const SE3& pose) {
  const double yaw = std::atan2(pose.R(1, 0), pose.R(0, 0));
  return {so3_exp({0, 0, yaw}), {pose.t.x(), pose.t.y(), 0}};
}

struct Fit {
  scan_match::Registration registration;
  double share = 0;  // compute_scene_share
};

class LoopSearch {
 public:
  LoopSearch(const Drive& drive, const OdometryOptions& options, const PosedScans& scans, const LoopParams& params)
      : drive_(drive), options_(options), scans_(scans), params_(params) {}

  std::vector<Loop> find_loops(const Tick& tick) const {
    std::vector<Loop> loops;
    EarlierPoses earlier_poses(scans_, params_);
    double next = params_.min_path_m;
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      tick();
      if (scans_.path_m[i] < next) continue;
      const std::optional<std::size_t> earlier = earlier_poses.find_nearest(i);
      if (!earlier) continue;
      next = scans_.path_m[i] + params_.candidate_step_m;
      if (std::optional<Loop> loop = try_pair(*earlier, i)) loops.push_back(*loop);
    }
    return loops;
  }

 private:
  /// Returns the loop between two poses if their scans fit together.
  std::optional<Loop> try_pair(std::size_t earlier, std::size_t later) const {
    scan_match::LocalMaps place = build_map_around(earlier, later);
    const Fit own = register_features(features(earlier).sparse, {{}, scans_.twist[earlier]}, place, 0);
    if (own.share < kLoopCheck.min_own_share) return std::nullopt;
    const SE3 motion = scans_.pose[earlier].inverse() * scans_.pose[later];
    const SE3 guess = params_.is_level ? level(motion) : motion;
    const double radius = predict_error_m(scans_.path_m[later] - scans_.path_m[earlier], params_);
    const scan_match::Features sparse = features(later).sparse;
    Fit best;
    for (const scan_match::ScanGuess& start : select_starts(sparse, {guess, scans_.twist[later]}, radius, place)) {
      const Fit found = register_features(sparse, start, place, 8);
      if (found.share > best.share) best = found;
    }
    const SE3& pose = best.registration.world_from_lidar;
    if (!is_good(best, own) || (pose.t - guess.t).norm() > radius || !is_confirmed(pose, own, later, place))
      return std::nullopt;
    return Loop{earlier, later, pose, best.registration.information};
  }

  scan_match::ScanFeatures features(std::size_t i) const {
    const std::shared_ptr<const Scan> scan = drive_.scans[scans_.scan_index[i]];
    return scan_match::extract_scan_features(drive_, *scan, scan_match::find_scan_rings(drive_, *scan), options_);
  }

  /// Builds a map in the axes of pose i from the scans before and after it, without its own and those close to pose `later`.
  scan_match::LocalMaps build_map_around(std::size_t i, std::size_t later) const {
    scan_match::LocalMaps scene = scan_match::make_empty_scene(options_);
    const auto add = [&](std::size_t k) {
      scene.add(features(k).dense, scans_.pose[i].inverse() * scans_.pose[k], scans_.twist[k]);
    };
    const double at = scans_.path_m[i],
                 last = std::min(at + params_.map_path_m, scans_.path_m[later] - 0.5 * params_.min_path_m);
    double next = at - params_.map_path_m;
    const auto from =
        std::partition_point(scans_.path_m.begin(), scans_.path_m.end(), [&](double path) { return path < next; });
    for (auto k = static_cast<std::size_t>(from - scans_.path_m.begin()); k < later && scans_.path_m[k] <= last; ++k)
      if (k != i && scans_.path_m[k] >= next) add(k), next = scans_.path_m[k] + params_.map_step_m;
    return scene;
  }

  Fit register_features(const scan_match::Features& sparse, const scan_match::ScanGuess& guess, scan_match::LocalMaps& place,
                        int coarse_iterations) const {
    scan_match::RegisterOptions options = scan_match::to_register_options(options_);
    options.coarse_iterations = coarse_iterations;
    options.iterations += coarse_iterations;
    options.prior_m = 1;
    Fit out;
    out.registration = scan_match::register_scan(sparse, guess, place, options);
    out.share = scan_match::compute_scene_share(sparse, out.registration, place, kLoopCheck.surface_noise * options_.noise_m);
    return out;
  }

  bool is_good(const Fit& fit, const Fit& own) const {
    return fit.registration.degenerate == 0 && fit.share > params_.min_relative_share * own.share &&
           fit.registration.residual_m < kLoopCheck.max_relative_residual * own.registration.residual_m;
  }

  /// Selects the poses on a grid around the guess at which most features lie on large planes and lines.
  std::vector<scan_match::ScanGuess> select_starts(const scan_match::Features& sparse, const scan_match::ScanGuess& guess,
                                                   double radius, scan_match::LocalMaps& place) const {
    struct Start {
      double score;
      SE3 pose;
    };
    std::vector<Eigen::Vector3d> planes, edges;
    for (std::size_t k = 0; k < sparse.planes.size(); k += kLoopStart.feature_step)
      planes.push_back(scan_match::compensate(sparse.planes[k], guess.twist));
    for (const scan_match::Feature& edge : sparse.edges) edges.push_back(scan_match::compensate(edge, guess.twist));
    std::vector<Start> all;
    const int cells = static_cast<int>(radius / params_.grid_step_m),
              turns = static_cast<int>(kLoopStart.max_turn_rad / kLoopStart.turn_step_rad);
    const int rise = params_.is_level ? 0 : cells;
    for (int x = -cells; x <= cells; ++x)
      for (int y = -cells; y <= cells; ++y)
        for (int z = -rise; z <= rise; ++z)
          for (int turn = -turns; turn <= turns && x * x + y * y + z * z <= cells * cells; ++turn) {
            SE3 pose = guess.world_from_lidar;
            pose.t += params_.grid_step_m * Eigen::Vector3d(x, y, z);
            pose.R = so3_exp({0, 0, kLoopStart.turn_step_rad * turn}) * pose.R;
            all.push_back({score(planes, pose, 1, place.coarse) + score(edges, pose, 2, place.edges), pose});
          }
    std::stable_sort(all.begin(), all.end(), [](const Start& a, const Start& b) { return a.score > b.score; });
    std::vector<scan_match::ScanGuess> out{guess};
    for (std::size_t k = 0; k < std::min(kLoopStart.best_starts, all.size()); ++k) out.push_back({all[k].pose, guess.twist});
    return out;
  }

  double score(const std::vector<Eigen::Vector3d>& points, const SE3& pose, int thin, scan_match::LocalMap& map) const {
    const double scale = kLoopStart.kernel_voxels * options_.voxel_m, scale2 = scale * scale;
    double out = 0;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = pose * point;
      const scan_match::Shape* shape = map.at(p, thin);
      if (shape == nullptr) continue;
      const double off2 = (shape->axes.leftCols(thin).transpose() * (p - shape->mean)).squaredNorm();
      out += scale2 / (scale2 + off2);
    }
    return out;
  }

  /// Returns whether a scan a little before the later one registers to where odometry predicts it.
  bool is_confirmed(const SE3& found, const Fit& own, std::size_t later, scan_match::LocalMaps& place) const {
    std::size_t k = later;
    while (k > 0 && scans_.path_m[later] - scans_.path_m[k] < params_.check_path_m) --k;
    const SE3 expected = found * (scans_.pose[later].inverse() * scans_.pose[k]);
    const Fit other = register_features(features(k).sparse, {expected, scans_.twist[k]}, place, 4);
    const SE3 off = expected.inverse() * other.registration.world_from_lidar;
    return is_good(other, own) && off.t.norm() < kLoopCheck.max_difference_noise * options_.noise_m &&
           so3_log(off.R).norm() < kLoopCheck.max_difference_rad;
  }

  const Drive& drive_;
  const OdometryOptions& options_;
  const PosedScans& scans_;
  const LoopParams& params_;
};

}  // namespace

std::vector<Loop> find_loops(const Drive& drive, const OdometryOptions& options, const Odometry& odometry, const Tick& tick) {
  const LoopParams params = get_params(drive);
  const PosedScans scans = list_posed_scans(odometry, params);
  return LoopSearch(drive, options, scans, params).find_loops(tick);
}

void close_loops(const Drive& drive, const OdometryOptions& options, Odometry& odometry, const Tick& tick) {
  const LoopParams params = get_params(drive);
  const PosedScans scans = list_posed_scans(odometry, params);
  const std::vector<Loop> loops = LoopSearch(drive, options, scans, params).find_loops(tick);
  if (loops.empty()) return;
  std::vector<scan_match::PoseEdge> edges;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const ScanFit& fit = odometry.scans[scans.scan_index[i]];
    const bool lost = fit.state == ScanFit::State::lost;
    edges.push_back({i - 1, i, scans.pose[i - 1].inverse() * scans.pose[i],
                     add_errors(fit.information, (lost ? kLoopGraph.lost_step_noise : kLoopGraph.step_noise) * options.noise_m,
                                lost ? kLoopGraph.lost_step_rad : kLoopGraph.step_rad)});
  }
  for (const Loop& loop : loops)
    edges.push_back({loop.earlier, loop.later, loop.earlier_from_later,
                     add_errors(loop.information, kLoopGraph.loop_noise * options.noise_m, kLoopGraph.loop_rad), true});
  std::vector<SE3> poses = scans.pose;
  const std::vector<double> weights = scan_match::solve_pose_graph(poses, edges);
  odometry.loops =
      static_cast<std::size_t>(std::count_if(weights.end() - static_cast<std::ptrdiff_t>(loops.size()), weights.end(),
                                             [](double weight) { return weight > kLoopGraph.min_inlier_weight; }));
  if (odometry.loops == 0) return;
  std::vector<StampedPose> stamped = odometry.world_from_lidar.poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    odometry.largest_correction_m = std::max(odometry.largest_correction_m, (poses[i].t - scans.pose[i].t).norm());
    stamped[i].world_from_body = poses[i];
  }
  odometry.world_from_lidar = Trajectory(std::move(stamped));
}

}  // namespace dvi::odometry
