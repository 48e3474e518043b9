#include "dvi/odometry/odometry.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "dvi/odometry/loop_closure.h"
#include "dvi/odometry/motion_prior.h"
#include "dvi/odometry/rgbd_odometry.h"
#include "dvi/odometry/rgbd_result.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::odometry {

namespace {

constexpr double kStartSpeedsMS[] = {0, 15, 30, -10};  // m/s forward; registration converges from an error of 10 m/s

/// Returns whether a fair share of the planar voxels is level and below the sensor, as the ground is if z points up.
bool has_ground_below(const scan_match::Features& features) {
  constexpr double kMinShare = 0.05, kMinNormalZ = 0.9, kVoxelM = 1.5;
  scan_match::LocalMap map(kVoxelM);
  for (const scan_match::Feature& f : features.planes) map.add(f.point.cast<double>());
  std::size_t flat = 0, ground = 0;
  map.each([&](const scan_match::Shape& shape) {
    flat += shape.thin == 1 ? 1 : 0;
    ground += shape.thin == 1 && shape.mean.z() < 0 && std::abs(shape.axes(2, 0)) > kMinNormalZ ? 1 : 0;
  });
  return static_cast<double>(ground) >= kMinShare * static_cast<double>(flat);
}

/// A scan in the window of the tracker.
struct WindowScan {
  std::size_t scan_index = 0;
  std::int64_t time_ns = 0;
  scan_match::ScanFeatures features;
  SE3 pose;
  Vector6d twist = Vector6d::Zero();
  bool given = false;  // the initial guess was that of the given poses
};

bool is_near(const SE3& a, const SE3& b) {
  const SE3 off = a.inverse() * b;
  return off.t.norm() < kOdometry.max_prior_difference_m && so3_log(off.R).norm() < kOdometry.max_prior_difference_rad;
}

/// The local map, and the window of scans whose poses may still change.
class ScanTracker {
 public:
  ScanTracker(const OdometryOptions& options, const MotionPrior& prior)
      : options_(&options), prior_(&prior), scene_(scan_match::make_empty_scene(options)) {}

  const WindowScan& last() const { return window_.back(); }
  const WindowScan& operator[](std::size_t i) const { return window_[i]; }
  std::size_t size() const { return window_.size(); }
  scan_match::LocalMaps& scene() { return scene_; }

  void add(WindowScan entry) {
    scene_.add(entry.features.dense, entry.pose, entry.twist);
    window_.push_back(std::move(entry));
  }

  /// Registers the next scan with the given motion or constant velocity as the initial guess.
  scan_match::Registration follow(WindowScan entry) {
    std::optional<scan_match::Registration> fit = register_with_prior(entry);
    entry.given = fit.has_value();
    if (!fit) fit = register_with_constant_velocity(entry);
    entry.pose = fit->world_from_lidar;
    entry.twist = fit->twist;
    add(std::move(entry));
    scene_.keep_near(last().pose.t, scan_match::find_feature_range(*options_) + kOdometry.map_margin_m);
    return *fit;
  }

  /// Registers the first two scans, with `twist` as the initial guess. The first scan is compensated with the motion found.
  scan_match::Registration begin(WindowScan first, WindowScan second, const Vector6d& twist, bool given) {
    const double dt = to_seconds(second.time_ns - first.time_ns);
    scan_match::Registration fit;
    fit.twist = twist;
    fit.world_from_lidar = se3_exp(fit.twist * dt);
    scan_match::RegisterOptions coarse = scan_match::to_register_options(*options_);
    coarse.coarse_iterations = 8;
    coarse.iterations = 12;
    coarse.prior_m = 1e3;
    coarse.keeps_guess = second.given = given;
    for (int round = 0; round < 4; ++round) {
      ScanTracker fresh(*options_, *prior_);
      first.twist = fit.twist;
      fresh.add(first);
      fit = scan_match::register_scan(second.features.sparse,
                                      {fit.world_from_lidar, fit.twist, first.pose, round == 0 ? 0 : dt}, fresh.scene_, coarse);
      if (round == 0) fit.twist = se3_log(fit.world_from_lidar) / dt;
      coarse.coarse_iterations = 0;
      *this = std::move(fresh);
    }
    window_.front().twist = fit.twist;
    second.pose = fit.world_from_lidar;
    second.twist = fit.twist;
    add(std::move(second));
    return fit;
  }

  /// Registers scan i of the window again, to the map without this scan.
  void refine(std::size_t i) {
    WindowScan& entry = window_[i];
    scan_match::RegisterOptions options = scan_match::to_register_options(*options_);
    options.keeps_guess = entry.given;
    scene_.remove(entry.features.dense, entry.pose, entry.twist);
    entry.twist = compute_twist(i);
    entry.pose = scan_match::register_scan(entry.features.sparse, {entry.pose, entry.twist}, scene_, options).world_from_lidar;
    entry.twist = compute_twist(i);
    scene_.add(entry.features.dense, entry.pose, entry.twist);
  }

  WindowScan pop() {
    WindowScan entry = std::move(window_.front());
    window_.pop_front();
    return entry;
  }

 private:
  /// Returns nothing if there is no given motion, or if constant velocity fits the scans better.
  std::optional<scan_match::Registration> register_with_prior(const WindowScan& entry) {
    const std::optional<SE3> motion = prior_->motion(last().time_ns, entry.time_ns);
    if (!motion) return std::nullopt;
    const double dt = to_seconds(entry.time_ns - last().time_ns);
    scan_match::RegisterOptions options = scan_match::to_register_options(*options_);
    options.keeps_guess = true;
    const SE3 guess = last().pose * *motion;
    const scan_match::Registration fit = scan_match::register_scan(
        entry.features.sparse, {guess, se3_log(*motion) / dt, last().pose, dt <= kOdometry.max_gap_s ? dt : 0}, scene_,
        options);
    const bool agrees = is_near(guess, fit.world_from_lidar);
    if (agrees && is_near(guess, last().pose * se3_exp(last().twist * dt))) return fit;
    const double factor = agrees ? kOdometry.prior_factor : 1 / kOdometry.prior_factor;
    const scan_match::Registration other = register_with_constant_velocity(entry);
    return factor * static_cast<double>(fit.inliers) > static_cast<double>(other.inliers) ? std::optional(fit) : std::nullopt;
  }

  scan_match::Registration register_with_constant_velocity(const WindowScan& entry) {
    const double dt = to_seconds(entry.time_ns - last().time_ns);
    const auto from = [&](double share, double within) {
      return scan_match::register_scan(entry.features.sparse,
                                       {last().pose * se3_exp(last().twist * dt * share), last().twist, last().pose, within},
                                       scene_, scan_match::to_register_options(*options_));
    };
    if (dt <= kOdometry.max_gap_s) return from(1, dt);
    scan_match::Registration fit = from(1, 0);
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.25}) {
      const scan_match::Registration other = from(share, 0);
      if (other.inliers > fit.inliers) fit = other;
    }
    return fit;
  }

  /// The mean velocity from the scan before to the scan after.
  Vector6d compute_twist(std::size_t i) const {
    const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, window_.size() - 1);
    const double dt = to_seconds(window_[b].time_ns - window_[a].time_ns);
    if (dt <= 0 || dt > 2 * kOdometry.max_gap_s) return window_[i].twist;
    return se3_log(window_[a].pose.inverse() * window_[b].pose) / dt;
  }

  const OdometryOptions* options_;
  const MotionPrior* prior_;
  scan_match::LocalMaps scene_;
  std::deque<WindowScan> window_;
};

class OdometryRun {
 public:
  OdometryRun(const Drive& drive, const OdometryOptions& options, const Trajectory& given, const Tick& tick)
      : drive_(drive), options_(options), prior_(given), tick_(tick), tracker_(options, prior_) {
    out_.scans.resize(drive.scan_headers.size());
  }

  Odometry run() {
    for (std::size_t i = 0; i < drive_.scan_headers.size(); ++i) {
      if (auto entry = read(i)) track(std::move(*entry));
      tick_();
    }
    if (!starting_.empty()) start();
    for (; refined_ < tracker_.size(); ++refined_)
      if (options_.lag > 0) refine_with_lag(refined_);
    while (tracker_.size() > 0) emit(tracker_.pop());
    finish();
    return std::move(out_);
  }

 private:
  std::optional<WindowScan> read(std::size_t i) {
    const ScanHeader& header = drive_.scan_headers[i];
    const std::shared_ptr<const Scan> scan = drive_.scans[i];
    ScanFit& fit = out_.scans[i];
    const bool same = (before_ && before_->points == scan->points) || (before_ && header.time_ns <= before_ns_);
    before_ = scan;
    if (same) {
      fit.state = ScanFit::State::duplicate;
      return std::nullopt;
    }
    before_ns_ = header.time_ns;
    const scan_match::Rings rings = scan_match::find_scan_rings(drive_, *scan);
    if (out_.rings.empty()) check_rings(rings, *scan);
    WindowScan entry;
    entry.scan_index = i;
    entry.time_ns = header.time_ns;
    entry.features = scan_match::extract_scan_features(drive_, *scan, rings, options_);
    const scan_match::Features& sparse = entry.features.sparse;
    fit.features = sparse.planes.size() + sparse.edges.size();
    if (fit.features < kOdometry.min_features) {
      fit.state = ScanFit::State::no_points;
      return std::nullopt;
    }
    out_.plane_features += sparse.planes.size();
    out_.edge_features += sparse.edges.size();
    return entry;
  }

  void check_rings(const scan_match::Rings& rings, const Scan& scan) {
    out_.rings = scan_match::to_string(rings.source);
    if (!scan.ring.empty() && rings.source != scan_match::Rings::Source::file)
      out_.warnings.push_back("the ring numbers of the scans do not separate the beams; the beams are separated by " +
                              out_.rings);
  }

  void track(WindowScan entry) {
    if (tracker_.size() == 0) {
      starting_.push_back(std::move(entry));
      if (starting_.size() == kOdometry.start_scans) start();
      return;
    }
    const std::size_t scan_index = entry.scan_index;
    const scan_match::Registration fit = tracker_.follow(std::move(entry));
    record(scan_index, fit, tracker_.last().given);
    const auto lag = static_cast<std::size_t>(options_.lag);
    if (lag > 0 && tracker_.size() - refined_ > lag) refine_with_lag(refined_++);
    // One finished scan stays, because the velocity of its neighbor depends on it.
    while (tracker_.size() > lag + 2) {
      emit(tracker_.pop());
      if (refined_ > 0) --refined_;
    }
  }

  /// Registers the first scans with each initial speed, and keeps the result with the most inliers.
  void start() {
    out_.scans[starting_.front().scan_index].state = ScanFit::State::first;
    const bool handheld = drive_.sensor == Sensor::depth_camera;  // any direction; slow at the start
    if (!handheld && !has_ground_below(starting_.front().features.dense))
      out_.warnings.emplace_back(
          "no ground was found below the LiDAR: its axes must be x forward, y left, z up; check the calibration");
    if (starting_.size() == 1) {
      tracker_.add(std::move(starting_.front()));
      starting_.clear();
      return;
    }
    double best_score = 0;
    std::vector<scan_match::Registration> best;
    const auto attempt = [&](const Vector6d& twist, bool given) {
      ScanTracker tracker(options_, prior_);
      std::vector<scan_match::Registration> fits{tracker.begin(starting_[0], starting_[1], twist, given)};
      for (std::size_t i = 2; i < starting_.size(); ++i) fits.push_back(tracker.follow(starting_[i]));
      double score = given ? kOdometry.prior_factor : 1;
      score *= std::accumulate(fits.begin(), fits.end(), 0.0, [](double sum, const scan_match::Registration& fit) {
        return sum + static_cast<double>(fit.inliers);
      });
      if (!best.empty() && score <= best_score) return;  // without any inlier, the scans are lost, but have poses
      best_score = score;
      best = std::move(fits);
      tracker_ = std::move(tracker);
    };
    const std::int64_t from = starting_[0].time_ns, to = starting_[1].time_ns;
    if (const auto motion = prior_.motion(from, to)) attempt(se3_log(*motion) / to_seconds(to - from), true);
    for (const double speed : kStartSpeedsMS)
      if (!handheld || speed == 0) attempt(speed * Vector6d::Unit(0), false);
    for (std::size_t i = 0; i < best.size(); ++i) record(starting_[i + 1].scan_index, best[i], tracker_[i + 1].given);
    starting_.clear();
  }

  void refine_with_lag(std::size_t i) {
    const Eigen::Vector3d first = tracker_[i].pose.t;
    tracker_.refine(i);
    out_.scans[tracker_[i].scan_index].lag_correction_m = (tracker_[i].pose.t - first).norm();
  }

  void record(std::size_t scan_index, const scan_match::Registration& fit, bool given) {
    ScanFit& out = out_.scans[scan_index];
    out.inliers = fit.inliers;
    out.residual_m = fit.residual_m;
    out.degenerate = fit.degenerate;
    out.given = given;
    out.information = fit.information;
    const double share = static_cast<double>(fit.inliers) / static_cast<double>(std::max<std::size_t>(fit.features, 1));
    const bool after_gap = scan_index > 0 && to_seconds(drive_.scan_headers[scan_index].time_ns -
                                                        drive_.scan_headers[scan_index - 1].time_ns) > kOdometry.max_gap_s;
    if (share < kOdometry.min_inlier_share || (after_gap && share < kOdometry.min_relative_share * average_share_))
      out.state = ScanFit::State::lost;
    average_share_ = average_share_ > 0 ? 0.8 * average_share_ + 0.2 * share : share;
  }

  void emit(const WindowScan& entry) { poses_.push_back({entry.time_ns, entry.pose}); }

  void finish() {
    if (poses_.empty()) return;
    const SE3 first_from_world = poses_.front().world_from_body.inverse();
    if (poses_.size() == 1) {
      out_.warnings.emplace_back("only one scan can be used: the vehicle is assumed to be stationary");
      poses_.push_back({poses_.front().time_ns + 100'000'000, poses_.front().world_from_body});
    }
    out_.world_from_lidar = Trajectory(std::move(poses_)).in(first_from_world);
    warn_of(ScanFit::State::no_points, "have too few points to be registered");
    warn_of(ScanFit::State::duplicate, "repeat the scan before and are skipped");
    const bool left_out = drive_.sensor == Sensor::depth_camera;
    warn_of(ScanFit::State::lost, left_out
                                      ? "do not fit the map of the scans before and have no pose: their images are left out"
                                      : "do not fit the map of the scans before: their poses are unreliable");
    const auto degenerate =
        std::count_if(out_.scans.begin(), out_.scans.end(), [](const ScanFit& f) { return f.degenerate > 0; });
    if (degenerate > 0)
      out_.warnings.push_back(
          fmt::format("{} of {} scans do not constrain the pose in some direction", degenerate, out_.scans.size()));
  }

  void warn_of(ScanFit::State state, const char* words) {
    const auto has_state = [&](const ScanFit& f) { return f.state == state; };
    const auto first = std::find_if(out_.scans.begin(), out_.scans.end(), has_state);
    if (first == out_.scans.end()) return;
    out_.warnings.push_back(fmt::format("{} of {} scans {} (the first: {})", std::count_if(first, out_.scans.end(), has_state),
                                        out_.scans.size(), words,
                                        drive_.scan_headers[static_cast<std::size_t>(first - out_.scans.begin())].name));
  }

  const Drive& drive_;
  const OdometryOptions& options_;
  const MotionPrior prior_;
  const Tick& tick_;
  ScanTracker tracker_;
  std::vector<WindowScan> starting_;
  double average_share_ = 0;
  std::size_t refined_ = 0;  // number of refined scans in the window
  std::vector<StampedPose> poses_;
  std::shared_ptr<const Scan> before_;
  std::int64_t before_ns_ = 0;
  Odometry out_;
};

/// Removes the poses of lost scans: a depth camera may be anywhere in the room when tracking resumes.
void remove_lost(const Drive& drive, Odometry& odometry) {
  std::vector<std::int64_t> lost_ns;
  for (std::size_t i = 0; i < odometry.scans.size(); ++i)
    if (odometry.scans[i].state == ScanFit::State::lost) lost_ns.push_back(drive.scan_headers[i].time_ns);
  if (lost_ns.empty()) return;
  std::vector<StampedPose> poses = odometry.world_from_lidar.poses();
  std::erase_if(poses, [&](const StampedPose& p) { return std::binary_search(lost_ns.begin(), lost_ns.end(), p.time_ns); });
  odometry.world_from_lidar = exclude_times(std::move(poses), lost_ns);
}

}  // namespace

OdometryOptions adapt_to_sensor(const Drive& drive, OdometryOptions options) {
  static_cast<scan_match::MatchOptions&>(options) = scan_match::adapt_to_sensor(options, drive);
  return options;
}

Odometry estimate_odometry(const Drive& drive, const OdometryOptions& given_options, const Trajectory& given,
                           const BeginPart& begin) {
  const OdometryOptions options = adapt_to_sensor(drive, given_options);
  if (has_color_and_depth(drive)) return rgbd_odometry(drive, options, given, begin);
  Odometry found = OdometryRun(drive, options, given, begin("odometry", drive.scan_headers.size())).run();
  if (options.loops) close_loops(drive, options, found, begin("loops", found.world_from_lidar.poses().size()));
  if (drive.sensor == Sensor::depth_camera) remove_lost(drive, found);
  return found;
}

const char* to_string(ScanFit::State state) {
  switch (state) {
    case ScanFit::State::registered:
      return "registered";
    case ScanFit::State::first:
      return "first";
    case ScanFit::State::no_points:
      return "no points";
    case ScanFit::State::duplicate:
      return "duplicate";
    case ScanFit::State::lost:
      return "lost";
  }
  return "";
}

}  // namespace dvi::odometry
