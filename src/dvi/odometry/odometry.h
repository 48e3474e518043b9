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

/// Returns the options with the range and the lengths of the drive's sensor (scan_match::adapt_to_sensor).
OdometryOptions adapt_to_sensor(const Drive& drive, OdometryOptions options);

/// Parameters of scan-to-map odometry.
struct OdometryParams {
  double max_gap_s = 0.55;                 ///< longer gaps between scans need a new search of the speed
  std::size_t start_scans = 4;             ///< scans that must agree on the initial speed
  std::size_t min_features = 100;          ///< of a scan that is registered
  double min_inlier_share = 0.25;          ///< of the features of a scan; otherwise the scan is lost
  double min_relative_share = 0.75;        ///< after a gap: inlier share over the average one
  double map_margin_m = 60;                ///< the local map exceeds the range of a scan by this
  double max_prior_difference_m = 0.3;     ///< between a given motion and the registered one
  double max_prior_difference_rad = 0.03;  ///< likewise
  double prior_factor = 1.01;              ///< a given motion that agrees may have fewer inliers by this factor
};
inline constexpr OdometryParams kOdometry;

/// The result of the registration of one scan.
struct ScanFit {
  enum class State { registered, first, no_points, duplicate, lost };
  State state = State::registered;
  std::size_t features = 0, inliers = 0;
  double residual_m = 0;                    ///< RMS distance of the inliers to the surfaces
  int degenerate = 0;                       ///< directions of motion that the scene does not constrain
  bool given = false;                       ///< in these directions the given poses decide; otherwise constant velocity
  double lag_correction_m = 0;              ///< displacement by the second, fixed-lag registration
  Matrix6d information = Matrix6d::Zero();  ///< Registration::information
};

struct Odometry {
  Trajectory world_from_lidar;                        ///< at the middle of each registered scan; the first is the identity
  std::vector<ScanFit> scans;                         ///< one per scan of the drive
  std::size_t plane_features = 0, edge_features = 0;  ///< sums over the registered scans
  std::string rings;                                  ///< how beams were separated: file, order, elevation, none
  std::vector<std::string> warnings;
  std::size_t loops = 0;            ///< loops that were closed
  double largest_correction_m = 0;  ///< largest displacement of a pose by closing loops
};

/// Estimates the poses of the scans (Zhang and Singh, LOAM, 2014; section 3.1 of the paper). Each scan is registered to a local
/// map of planes and lines from the scans before it, and again after `lag` more scans. The first scans are tried with several
/// speeds. The initial guess is constant velocity, or the motion of the `given` poses unless they jump or contradict the scans;
/// it decides in directions that the scene does not constrain. Loops are closed at the end (loop_closure.h). A drive of a depth
/// camera with color goes to rgbd_odometry(). Reports two parts of progress, "odometry" and "loops".
Odometry estimate_odometry(const Drive& drive, const OdometryOptions& options, const Trajectory& given = {},
                           const BeginPart& begin = no_parts);

const char* to_string(ScanFit::State state);

}  // namespace dvi::odometry
