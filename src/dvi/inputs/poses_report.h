#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/inputs/choose_poses.h"

namespace dvi::inputs {

struct SharpnessReport {
  double ground_m = 0, vertical_m = 0;
  std::size_t ground_patches = 0, vertical_patches = 0;
};

/// Middle and largest of some lengths.
struct LengthReport {
  double median_m = 0, largest_m = 0;
};

/// How far the odometry's motion over 10 m is from the given poses'.
struct MotionReport {
  double median_m = 0, largest_m = 0, median_deg = 0, largest_deg = 0;
};

/// What tells how far off the odometry's poses may be, whether there is a truth or not.
struct DriftReport {
  std::optional<LengthReport> lag_correction;
  std::optional<MotionReport> given_over_10_m;
  std::size_t loops = 0;
  double largest_correction_m = 0;
};

/// One scan in the odometry.
struct ScanReport {
  std::string state, guess;
  std::size_t features = 0, inliers = 0;
  double residual_m = 0, lag_correction_m = 0;
  int degenerate_directions = 0;
};

struct OdometryReport {
  std::string rings;
  double path_m = 0;
  std::size_t plane_features = 0, edge_features = 0;
  DriftReport drift;
  std::vector<ScanReport> scans;
};

/// What map.json and report.json say of a drive's poses.
struct PosesReport {
  std::string from;
  std::optional<SharpnessReport> given, loam;
  std::optional<OdometryReport> odometry;
};

PosesReport poses_report(const Drive& drive, const PoseChoice& choice);

}  // namespace dvi::inputs
