#include "dvi/odometry/odometry.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/threads.h"
#include "dvi/odometry/loop_closure.h"
#include "dvi/odometry/motion_prior.h"
#include "dvi/odometry/rgbd_odometry.h"
#include "dvi/odometry/rgbd_result.h"
#include "dvi/odometry/scan_tracker.h"
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

/// A scan and its features, which do not depend on other scans.
struct ReadScan {
  std::shared_ptr<const Scan> scan;
  scan_match::Rings rings;
  scan_match::ScanFeatures features;
};

class OdometryRun {
 public:
  OdometryRun(const Drive& drive, const OdometryOptions& options, const Trajectory& given, const Tick& tick)
      : drive_(drive), options_(options), prior_(given), tick_(tick), tracker_(options, prior_) {
    out_.scans.resize(drive.scan_headers.size());
  }

  Odometry run() {
    make_and_use(
        drive_.scan_headers.size(), [&](std::size_t i) { return read(i); },
        [&](std::size_t i, ReadScan scan) {
          if (auto entry = check(i, std::move(scan))) track(std::move(*entry));
          tick_();
        });
    if (!starting_.empty()) start();
    for (; refined_ < tracker_.size(); ++refined_)
      if (options_.lag > 0) refine_with_lag(refined_);
    while (tracker_.size() > 0) emit(tracker_.pop());
    finish();
    return std::move(out_);
  }

 private:
  ReadScan read(std::size_t i) const {
    ReadScan out{drive_.scans[i], {}, {}};
    out.rings = scan_match::find_scan_rings(drive_, *out.scan);
    out.features = scan_match::extract_scan_features(drive_, *out.scan, out.rings, options_);
    return out;
  }

  /// Returns the scan, or nothing if it repeats the scan before, or has too few features.
  std::optional<WindowScan> check(std::size_t i, ReadScan read) {
    const ScanHeader& header = drive_.scan_headers[i];
    const std::shared_ptr<const Scan>& scan = read.scan;
    ScanFit& fit = out_.scans[i];
    const bool same = (before_ && before_->points == scan->points) || (before_ && header.time_ns <= before_ns_);
    before_ = scan;
    if (same) {
      fit.state = ScanFit::State::duplicate;
      return std::nullopt;
    }
    before_ns_ = header.time_ns;
    if (out_.rings.empty()) check_rings(read.rings, *scan);
    WindowScan entry;
    entry.scan_index = i;
    entry.time_ns = header.time_ns;
    entry.features = std::move(read.features);
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
    std::vector<StartAttempt> attempts;
    const std::int64_t from = starting_[0].time_ns, to = starting_[1].time_ns;
    if (const auto motion = prior_.motion(from, to))
      attempts.emplace_back(ScanTracker(options_, prior_), se3_log(*motion) / to_seconds(to - from), true);
    for (const double speed : kStartSpeedsMS)
      if (!handheld || speed == 0) attempts.emplace_back(ScanTracker(options_, prior_), speed * Vector6d::Unit(0), false);
    parallel_for(attempts.size(), [&](std::size_t k) { attempts[k].run(starting_); });
    const auto best = std::max_element(attempts.begin(), attempts.end(),
                                       [](const StartAttempt& a, const StartAttempt& b) { return a.score < b.score; });
    tracker_ = std::move(best->tracker);
    for (std::size_t i = 0; i < best->fits.size(); ++i)
      record(starting_[i + 1].scan_index, best->fits[i], tracker_[i + 1].given);
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
