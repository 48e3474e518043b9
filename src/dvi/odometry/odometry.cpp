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

using namespace scan_match;

namespace {

constexpr double kLongGap = 0.55;               // seconds without a scan, after which the speed is searched for anew
constexpr double kSpeeds[] = {0, 15, 30, -10};  // m/s forward, tried at a cold start: a start is caught from 10 m/s off
constexpr std::size_t kStartScans = 4;          // that must agree on the speed
constexpr std::size_t kFewestFeatures = 100;
constexpr double kLeastShare = 0.25;               // of the features must fit, else the track is lost ...
constexpr double kLeastOfUsual = 0.75;             // ... and, after a gap, of the usual share
constexpr double kMargin = 60;                     // meters by which the local map reaches farther than a scan
constexpr double kAgree = 0.3, kAgreeTurn = 0.03;  // meters and radians between a given step and what it is held against
constexpr double kBelief = 1.01;  // a given motion that scans do not contradict may fit so much worse than another

/// Whether a fair share of what is flat lies level below the sensor, as the ground does where z is up.
bool has_ground_below(const scan_match::Features& features) {
  constexpr double kLeast = 0.05, kLevel = 0.9;
  scan_match::LocalMap map(1.5);
  for (const scan_match::Feature& f : features.planes) map.add(f.point.cast<double>());
  std::size_t flat = 0, ground = 0;
  map.each([&](const scan_match::Shape& shape) {
    flat += shape.thin == 1 ? 1 : 0;
    ground += shape.thin == 1 && shape.mean.z() < 0 && std::abs(shape.axes(2, 0)) > kLevel ? 1 : 0;
  });
  return static_cast<double>(ground) >= kLeast * static_cast<double>(flat);
}

/// A scan on its way through the window.
struct Entry {
  std::size_t scan_index = 0;
  std::int64_t time_ns = 0;
  scan_match::ScanFeatures features;
  SE3 pose;
  Vector6d twist = Vector6d::Zero();
  bool given = false;  // its motion was guessed from given poses
};

bool agree(const SE3& a, const SE3& b) {
  const SE3 off = a.inverse() * b;
  return off.t.norm() < kAgree && so3_log(off.R).norm() < kAgreeTurn;
}

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// The local map and the scans that may still move.
class Track {
 public:
  Track(const OdometryOptions& options, const MotionPrior& prior)
      : options_(&options), prior_(&prior), scene_(scan_match::make_empty_scene(options)) {}

  const Entry& last() const { return window_.back(); }
  const Entry& operator[](std::size_t i) const { return window_[i]; }
  std::size_t size() const { return window_.size(); }
  scan_match::LocalMaps& scene() { return scene_; }

  void put(Entry entry) {
    scene_.add(entry.features.dense, entry.pose, entry.twist);
    window_.push_back(std::move(entry));
  }

  /// Registers the next scan from the given motion, or from the motion so far.
  scan_match::Registration follow(Entry entry) {
    std::optional<scan_match::Registration> fit = follow_given(entry);
    entry.given = fit.has_value();
    if (!fit) fit = follow_motion(entry);
    entry.pose = fit->world_from_lidar;
    entry.twist = fit->twist;
    put(std::move(entry));
    scene_.keep_near(last().pose.t, scan_match::find_feature_range(*options_) + kMargin);
    return *fit;
  }

  /// The first two scans, if the car moves about like this: the first is compensated with what the second finds.
  scan_match::Registration begin(Entry first, Entry second, const Vector6d& twist, bool given) {
    const double dt = seconds(second.time_ns - first.time_ns);
    scan_match::Registration fit;
    fit.twist = twist;
    fit.world_from_lidar = se3_exp(fit.twist * dt);
    scan_match::RegisterOptions coarse = scan_match::to_register_options(*options_);
    coarse.coarse_iterations = 8;
    coarse.iterations = 12;
    coarse.prior_m = 1e3;
    coarse.keeps_guess = second.given = given;
    for (int round = 0; round < 4; ++round) {
      Track fresh(*options_, *prior_);
      first.twist = fit.twist;
      fresh.put(first);
      fit = scan_match::register_scan(second.features.sparse, fit.world_from_lidar, fit.twist, first.pose, round == 0 ? 0 : dt,
                                      fresh.scene_, coarse);
      if (round == 0) fit.twist = se3_log(fit.world_from_lidar) / dt;
      coarse.coarse_iterations = 0;
      *this = std::move(fresh);
    }
    window_.front().twist = fit.twist;
    second.pose = fit.world_from_lidar;
    second.twist = fit.twist;
    put(std::move(second));
    return fit;
  }

  /// Registers scan i of the window again, against all that is in the map but itself.
  void refine(std::size_t i) {
    Entry& entry = window_[i];
    scan_match::RegisterOptions options = scan_match::to_register_options(*options_);
    options.keeps_guess = entry.given;
    scene_.remove(entry.features.dense, entry.pose, entry.twist);
    entry.twist = smooth_twist(i);
    entry.pose =
        scan_match::register_scan(entry.features.sparse, entry.pose, entry.twist, {}, 0, scene_, options).world_from_lidar;
    entry.twist = smooth_twist(i);
    scene_.add(entry.features.dense, entry.pose, entry.twist);
  }

  Entry pop() {
    Entry entry = std::move(window_.front());
    window_.pop_front();
    return entry;
  }

 private:
  /// None where there is no given motion, or the motion so far fits the scans better.
  std::optional<scan_match::Registration> follow_given(const Entry& entry) {
    const std::optional<SE3> motion = prior_->motion(last().time_ns, entry.time_ns);
    if (!motion) return std::nullopt;
    const double dt = seconds(entry.time_ns - last().time_ns);
    scan_match::RegisterOptions options = scan_match::to_register_options(*options_);
    options.keeps_guess = true;
    const SE3 guess = last().pose * *motion;
    const scan_match::Registration fit = scan_match::register_scan(entry.features.sparse, guess, se3_log(*motion) / dt,
                                                                   last().pose, dt <= kLongGap ? dt : 0, scene_, options);
    const bool kept = agree(guess, fit.world_from_lidar);
    if (kept && agree(guess, last().pose * se3_exp(last().twist * dt))) return fit;
    const double belief = kept ? kBelief : 1 / kBelief;
    const scan_match::Registration other = follow_motion(entry);
    return belief * static_cast<double>(fit.inliers) > static_cast<double>(other.inliers) ? std::optional(fit) : std::nullopt;
  }

  scan_match::Registration follow_motion(const Entry& entry) {
    const double dt = seconds(entry.time_ns - last().time_ns);
    const auto from = [&](double share, double within) {
      return scan_match::register_scan(entry.features.sparse, last().pose * se3_exp(last().twist * dt * share), last().twist,
                                       last().pose, within, scene_, scan_match::to_register_options(*options_));
    };
    if (dt <= kLongGap) return from(1, dt);
    scan_match::Registration fit = from(1, 0);
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.25}) {
      const scan_match::Registration other = from(share, 0);
      if (other.inliers > fit.inliers) fit = other;
    }
    return fit;
  }

  // From the scan before to the one after.
  Vector6d smooth_twist(std::size_t i) const {
    const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, window_.size() - 1);
    const double dt = seconds(window_[b].time_ns - window_[a].time_ns);
    if (dt <= 0 || dt > 2 * kLongGap) return window_[i].twist;
    return se3_log(window_[a].pose.inverse() * window_[b].pose) / dt;
  }

  const OdometryOptions* options_;
  const MotionPrior* prior_;
  scan_match::LocalMaps scene_;
  std::deque<Entry> window_;
};

class Runner {
 public:
  Runner(const Drive& drive, const OdometryOptions& options, const Trajectory& given, const Tick& tick)
      : drive_(drive), options_(options), prior_(given), tick_(tick), track_(options, prior_) {
    out_.scans.resize(drive.scan_headers.size());
  }

  Odometry operator()() {
    for (std::size_t i = 0; i < drive_.scan_headers.size(); ++i) {
      if (auto entry = read(i)) take(std::move(*entry));
      tick_();
    }
    if (!starting_.empty()) start();
    for (; refined_ < track_.size(); ++refined_)
      if (options_.lag > 0) refine_with_lag(refined_);
    while (track_.size() > 0) emit(track_.pop());
    finish();
    return std::move(out_);
  }

 private:
  std::optional<Entry> read(std::size_t i) {
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
    if (out_.rings.empty()) note_rings(rings, *scan);
    Entry entry;
    entry.scan_index = i;
    entry.time_ns = header.time_ns;
    entry.features = scan_match::extract_scan_features(drive_, *scan, rings, options_);
    const scan_match::Features& sparse = entry.features.sparse;
    fit.features = sparse.planes.size() + sparse.edges.size();
    if (fit.features < kFewestFeatures) {
      fit.state = ScanFit::State::no_points;
      return std::nullopt;
    }
    out_.plane_features += sparse.planes.size();
    out_.edge_features += sparse.edges.size();
    return entry;
  }

  void note_rings(const scan_match::Rings& rings, const Scan& scan) {
    out_.rings = scan_match::to_string(rings.source);
    if (!scan.ring.empty() && rings.source != scan_match::Rings::Source::file)
      out_.warnings.push_back("the scans' ring numbers do not tell beams apart: beams are found by " + out_.rings);
  }

  void take(Entry entry) {
    if (track_.size() == 0) {
      starting_.push_back(std::move(entry));
      if (starting_.size() == kStartScans) start();
      return;
    }
    const std::size_t scan_index = entry.scan_index;
    const scan_match::Registration fit = track_.follow(std::move(entry));
    record(scan_index, fit, track_.last().given);
    const auto lag = static_cast<std::size_t>(options_.lag);
    if (lag > 0 && track_.size() - refined_ > lag) refine_with_lag(refined_++);
    // One scan that is done stays, for its neighbor's motion.
    while (track_.size() > lag + 2) {
      emit(track_.pop());
      if (refined_ > 0) --refined_;
    }
  }

  // From each speed through the first scans; the one whose scans fit best.
  void start() {
    out_.scans[starting_.front().scan_index].state = ScanFit::State::first;
    const bool handheld = drive_.sensor == Sensor::depth_camera;  // may look anywhere, and starts slowly
    if (!handheld && !has_ground_below(starting_.front().features.dense))
      out_.warnings.emplace_back("there is no ground below the LiDAR: its axes must be x forward, y left, z up");
    if (starting_.size() == 1) {
      track_.put(std::move(starting_.front()));
      starting_.clear();
      return;
    }
    double most = 0;
    std::vector<scan_match::Registration> best;
    const auto attempt = [&](const Vector6d& twist, bool given) {
      Track track(options_, prior_);
      std::vector<scan_match::Registration> fits{track.begin(starting_[0], starting_[1], twist, given)};
      for (std::size_t i = 2; i < starting_.size(); ++i) fits.push_back(track.follow(starting_[i]));
      double score = given ? kBelief : 1;
      score *= std::accumulate(fits.begin(), fits.end(), 0.0, [](double sum, const scan_match::Registration& fit) {
        return sum + static_cast<double>(fit.inliers);
      });
      if (score <= most) return;
      most = score;
      best = std::move(fits);
      track_ = std::move(track);
    };
    const std::int64_t from = starting_[0].time_ns, to = starting_[1].time_ns;
    if (const auto motion = prior_.motion(from, to)) attempt(se3_log(*motion) / seconds(to - from), true);
    for (const double speed : kSpeeds)
      if (!handheld || speed == 0) attempt(speed * Vector6d::Unit(0), false);
    for (std::size_t i = 0; i < best.size(); ++i) record(starting_[i + 1].scan_index, best[i], track_[i + 1].given);
    starting_.clear();
  }

  void refine_with_lag(std::size_t i) {
    const Eigen::Vector3d first = track_[i].pose.t;
    track_.refine(i);
    out_.scans[track_[i].scan_index].lag_correction_m = (track_[i].pose.t - first).norm();
  }

  void record(std::size_t scan_index, const scan_match::Registration& fit, bool given) {
    ScanFit& out = out_.scans[scan_index];
    out.inliers = fit.inliers;
    out.residual_m = fit.residual_m;
    out.degenerate = fit.degenerate;
    out.given = given;
    out.information = fit.information;
    const double share = static_cast<double>(fit.inliers) / static_cast<double>(std::max<std::size_t>(fit.features, 1));
    const bool after_gap = scan_index > 0 && seconds(drive_.scan_headers[scan_index].time_ns -
                                                     drive_.scan_headers[scan_index - 1].time_ns) > kLongGap;
    if (share < kLeastShare || (after_gap && share < kLeastOfUsual * usual_share_)) out.state = ScanFit::State::lost;
    usual_share_ = usual_share_ > 0 ? 0.8 * usual_share_ + 0.2 * share : share;
  }

  void emit(const Entry& entry) { poses_.push_back({entry.time_ns, entry.pose}); }

  void finish() {
    if (poses_.empty()) return;
    const SE3 first_from_world = poses_.front().world_from_body.inverse();
    if (poses_.size() == 1) {
      out_.warnings.emplace_back("only one scan can be used: the car is taken to stand still");
      poses_.push_back({poses_.front().time_ns + 100'000'000, poses_.front().world_from_body});
    }
    out_.world_from_lidar = Trajectory(std::move(poses_)).in(first_from_world);
    count(ScanFit::State::no_points, "hold too few points to be registered");
    count(ScanFit::State::duplicate, "repeat the one before and are bridged");
    const bool left_out = drive_.sensor == Sensor::depth_camera;
    count(ScanFit::State::lost, left_out ? "do not fit the map before them and have no pose: the images there are left out"
                                         : "do not fit the map before them: the poses there are not to be trusted");
    const auto held = std::count_if(out_.scans.begin(), out_.scans.end(), [](const ScanFit& f) { return f.degenerate > 0; });
    if (held > 0)
      out_.warnings.push_back(
          fmt::format("{} of {} scans see nothing that holds them in some direction", held, out_.scans.size()));
  }

  void count(ScanFit::State state, const char* words) {
    const auto is = [&](const ScanFit& f) { return f.state == state; };
    const auto first = std::find_if(out_.scans.begin(), out_.scans.end(), is);
    if (first == out_.scans.end()) return;
    out_.warnings.push_back(fmt::format("{} of {} scans {} (the first: {})", std::count_if(first, out_.scans.end(), is),
                                        out_.scans.size(), words,
                                        drive_.scan_headers[static_cast<std::size_t>(first - out_.scans.begin())].name));
  }

  const Drive& drive_;
  const OdometryOptions& options_;
  const MotionPrior prior_;
  const Tick& tick_;
  Track track_;
  std::vector<Entry> starting_;
  double usual_share_ = 0;
  std::size_t refined_ = 0;  // of the window
  std::vector<StampedPose> poses_;
  std::shared_ptr<const Scan> before_;
  std::int64_t before_ns_ = 0;
  Odometry out_;
};

/// Removes the poses of scans that were lost. A depth camera that was lost once is found again anywhere in the room.
void leave_out_lost(const Drive& drive, Odometry& odometry) {
  std::vector<std::int64_t> lost_ns;
  for (std::size_t i = 0; i < odometry.scans.size(); ++i)
    if (odometry.scans[i].state == ScanFit::State::lost) lost_ns.push_back(drive.scan_headers[i].time_ns);
  if (lost_ns.empty()) return;
  std::vector<StampedPose> poses = odometry.world_from_lidar.poses();
  std::erase_if(poses, [&](const StampedPose& p) { return std::binary_search(lost_ns.begin(), lost_ns.end(), p.time_ns); });
  odometry.world_from_lidar = without_poses_at(std::move(poses), lost_ns);
}

}  // namespace

OdometryOptions suited(const Drive& drive, OdometryOptions options) {
  static_cast<scan_match::MatchOptions&>(options) = scan_match::adapt_to_sensor(options, drive);
  return options;
}

Odometry odometry(const Drive& drive, const OdometryOptions& given_options, const Trajectory& given, const BeginPart& begin) {
  const OdometryOptions options = suited(drive, given_options);
  if (has_color_and_depth(drive)) return rgbd_odometry(drive, options, given, begin);
  Odometry found = Runner(drive, options, given, begin("odometry", drive.scan_headers.size()))();
  if (options.loops) close_loops(drive, options, found, begin("loops", found.world_from_lidar.poses().size()));
  if (drive.sensor == Sensor::depth_camera) leave_out_lost(drive, found);
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
