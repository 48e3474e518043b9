#include "dvi/odometry/scan_tracker.h"

#include <algorithm>
#include <utility>

namespace dvi::odometry {
namespace {

bool is_near(const SE3& a, const SE3& b) {
  const SE3 off = a.inverse() * b;
  return off.t.norm() < kOdometry.max_prior_difference_m && so3_log(off.R).norm() < kOdometry.max_prior_difference_rad;
}

}  // namespace

ScanTracker::ScanTracker(const OdometryOptions& options, const MotionPrior& prior)
    : options_(&options), prior_(&prior), scene_(scan_match::make_empty_scene(options)) {}

void ScanTracker::add(WindowScan entry) {
  scene_.add(entry.features.dense, entry.pose, entry.twist);
  window_.push_back(std::move(entry));
}

scan_match::Registration ScanTracker::follow(WindowScan entry) {
  std::optional<scan_match::Registration> fit = register_with_prior(entry);
  entry.given = fit.has_value();
  if (!fit) fit = register_with_constant_velocity(entry);
  entry.pose = fit->world_from_lidar;
  entry.twist = fit->twist;
  add(std::move(entry));
  scene_.keep_near(last().pose.t, scan_match::find_feature_range(*options_) + kOdometry.map_margin_m);
  return *fit;
}

scan_match::Registration ScanTracker::begin(WindowScan first, WindowScan second, const Vector6d& twist, bool given) {
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
    fit = scan_match::register_scan(second.features.sparse, {fit.world_from_lidar, fit.twist, first.pose, round == 0 ? 0 : dt},
                                    fresh.scene_, coarse);
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

void ScanTracker::refine(std::size_t i) {
  WindowScan& entry = window_[i];
  scan_match::RegisterOptions options = scan_match::to_register_options(*options_);
  options.keeps_guess = entry.given;
  scene_.remove(entry.features.dense, entry.pose, entry.twist);
  entry.twist = compute_twist(i);
  entry.pose = scan_match::register_scan(entry.features.sparse, {entry.pose, entry.twist}, scene_, options).world_from_lidar;
  entry.twist = compute_twist(i);
  scene_.add(entry.features.dense, entry.pose, entry.twist);
}

WindowScan ScanTracker::pop() {
  WindowScan entry = std::move(window_.front());
  window_.pop_front();
  return entry;
}

/// Returns nothing if there is no given motion, or if constant velocity fits the scans better.
std::optional<scan_match::Registration> ScanTracker::register_with_prior(const WindowScan& entry) {
  const std::optional<SE3> motion = prior_->motion(last().time_ns, entry.time_ns);
  if (!motion) return std::nullopt;
  const double dt = to_seconds(entry.time_ns - last().time_ns);
  scan_match::RegisterOptions options = scan_match::to_register_options(*options_);
  options.keeps_guess = true;
  const SE3 guess = last().pose * *motion;
  const scan_match::Registration fit = scan_match::register_scan(
      entry.features.sparse, {guess, se3_log(*motion) / dt, last().pose, dt <= kOdometry.max_gap_s ? dt : 0}, scene_, options);
  const bool agrees = is_near(guess, fit.world_from_lidar);
  if (agrees && is_near(guess, last().pose * se3_exp(last().twist * dt))) return fit;
  const double factor = agrees ? kOdometry.prior_factor : 1 / kOdometry.prior_factor;
  const scan_match::Registration other = register_with_constant_velocity(entry);
  return factor * static_cast<double>(fit.inliers) > static_cast<double>(other.inliers) ? std::optional(fit) : std::nullopt;
}

scan_match::Registration ScanTracker::register_with_constant_velocity(const WindowScan& entry) {
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
Vector6d ScanTracker::compute_twist(std::size_t i) const {
  const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, window_.size() - 1);
  const double dt = to_seconds(window_[b].time_ns - window_[a].time_ns);
  if (dt <= 0 || dt > 2 * kOdometry.max_gap_s) return window_[i].twist;
  return se3_log(window_[a].pose.inverse() * window_[b].pose) / dt;
}

void StartAttempt::run(const std::vector<WindowScan>& scans) {
  fits.push_back(tracker.begin(scans[0], scans[1], twist, given));
  for (std::size_t i = 2; i < scans.size(); ++i) fits.push_back(tracker.follow(scans[i]));
  for (const scan_match::Registration& fit : fits) score += static_cast<double>(fit.inliers);
  if (given) score *= kOdometry.prior_factor;
}

}  // namespace dvi::odometry
