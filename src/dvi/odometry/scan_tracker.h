#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "dvi/geometry/se3.h"
#include "dvi/odometry/motion_prior.h"
#include "dvi/odometry/odometry.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::odometry {

/// A scan in the window of the tracker.
struct WindowScan {
  std::size_t scan_index = 0;
  std::int64_t time_ns = 0;
  scan_match::ScanFeatures features;
  SE3 pose;
  Vector6d twist = Vector6d::Zero();
  bool given = false;  ///< The initial guess was that of the given poses.
};

/// The local map, and the window of scans whose poses may still change.
class ScanTracker {
 public:
  ScanTracker(const OdometryOptions& options, const MotionPrior& prior);

  const WindowScan& last() const { return window_.back(); }
  const WindowScan& operator[](std::size_t i) const { return window_[i]; }
  std::size_t size() const { return window_.size(); }

  void add(WindowScan entry);
  /// Removes the first scan from the window; the map keeps it.
  WindowScan pop();

  /// Registers the next scan with the given motion or constant velocity as the initial guess.
  scan_match::Registration follow(WindowScan entry);
  /// Registers the first two scans, with `twist` as the initial guess. The first scan is compensated with the motion found.
  scan_match::Registration begin(WindowScan first, WindowScan second, const Vector6d& twist, bool given);
  /// Registers scan i of the window again, to the map without this scan.
  void refine(std::size_t i);

 private:
  std::optional<scan_match::Registration> register_with_prior(const WindowScan& entry);
  scan_match::Registration register_with_constant_velocity(const WindowScan& entry);
  Vector6d compute_twist(std::size_t i) const;

  const OdometryOptions* options_;
  const MotionPrior* prior_;
  scan_match::LocalMaps scene_;
  std::deque<WindowScan> window_;
};

/// The registration of the first scans with an initial speed.
struct StartAttempt {
  ScanTracker tracker;
  Vector6d twist;  ///< The initial speed.
  bool given;      ///< The initial speed is that of the given poses.

  std::vector<scan_match::Registration> fits = {};  ///< One per scan after the first.
  double score = 0;                                 ///< Number of inliers, times a factor if the initial speed is given.

  void run(const std::vector<WindowScan>& scans);
};

}  // namespace dvi::odometry
