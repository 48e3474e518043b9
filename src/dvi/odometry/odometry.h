#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/drive.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::odometry {

struct OdometryOptions : scan_match::MatchOptions {
  int lag = 10;
  bool loops = true;

  void describe(OptionTable& table) {
    table.section("odometry");
    table.developer();
    table.add("loops", loops, "Close loops where the drive returns to a place.");
    table.add("spacing_m", spacing_m, {0.02, 2}, "Edge of the cubes that give one feature each to the local map.");
    table.add("cell_m", cell_m, {0.1, 5}, "Edge of the cubes that give one feature each to registration.");
    table.add("voxel_m", voxel_m, {0.1, 5}, "Edge of the small voxels of the local map; large ones are three times as wide.");
    table.add("noise_m", noise_m, {0.001, 1}, "Standard deviation of returns across a flat surface.");
    table.add("kernel_m", kernel_m, {0.01, 2}, "Scale of the robust kernel: larger distances to a surface are outliers.");
    table.add("lag", lag, {0, 100}, "Fixed lag in scans after which a pose is estimated again from both sides; 0: never.");
  }
};

/// With the range of the drive's sensor and lengths that suit it (scan_match::for_sensor).
OdometryOptions suited(const Drive& drive, OdometryOptions options);

/// How the registration of one scan went.
struct ScanFit {
  enum class State { registered, first, no_points, duplicate, lost };
  State state = State::registered;
  std::size_t features = 0, inliers = 0;
  double residual_m = 0;                    ///< RMS distance of inliers across the surfaces
  int degenerate = 0;                       ///< directions of motion that the scene does not hold
  bool given = false;                       ///< there the given poses decided; else the motion goes on as before
  double lag_correction_m = 0;              ///< how far the fixed-lag registration moved it
  Matrix6d information = Matrix6d::Zero();  ///< Registration::information
};

struct Odometry {
  Trajectory world_from_lidar;                        ///< at the middle of each registered scan; the first is the identity
  std::vector<ScanFit> scans;                         ///< as the drive's
  std::size_t plane_features = 0, edge_features = 0;  ///< registered, of all scans
  std::string rings;                                  ///< how beams were told: file, order, elevation, none
  std::vector<std::string> warnings;
  std::size_t loops = 0;            ///< closed
  double largest_correction_m = 0;  ///< of a pose, by closing them
};

/// Poses from the scans (Zhang and Singh, LOAM, 2014): each scan is registered against a local map of planes and lines that
/// the scans before it left, and again when `lag` more have come. A start tries several speeds. The motion between scans is
/// guessed to go on as before, or taken from `given` poses where these neither jump nor contradict the scans; it decides in
/// directions that the scene does not hold. Then loops are closed (loop_closure.h). Parts: odometry, loops.
Odometry odometry(const Drive& drive, const OdometryOptions& options, const Trajectory& given = {},
                  const BeginPart& begin = no_parts);

const char* to_string(ScanFit::State state);

}  // namespace dvi::odometry
