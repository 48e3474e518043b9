#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/diagnostics/pose_reading.h"
#include "dvi/diagnostics/scan_tracks.h"
#include "dvi/drive/drive.h"
#include "dvi/job/choices.h"
#include "dvi/odometry/odometry.h"
#include "dvi/odometry/sharpness.h"

namespace dvi::inputs {

enum class PoseOrigin { given, loam };
constexpr auto names_of(PoseOrigin) {
  return std::array{std::pair{PoseOrigin::given, "given"}, std::pair{PoseOrigin::loam, "loam"}};
}

/// The source of a drive's poses, and the sharpness of the map that they make.
struct PoseChoice {
  PoseOrigin from = PoseOrigin::given;
  std::optional<odometry::Odometry> odometry;
  std::optional<odometry::Sharpness> given, loam;
  std::vector<diagnostics::ScanTrack> tracks;       ///< relative motion in the scans, with which poses are compared
  std::optional<diagnostics::PoseReading> misread;  ///< other meaning of the given poses; they are not used as a guess
  std::vector<std::string> warnings;                ///< about misread poses, and about maps with too few patches
};

/// Chooses the poses of a drive. `automatic` compares the given poses with poses estimated from the scans, for which the given
/// motion is the initial guess, and chooses those that make the sharper map. Given poses that are as good are kept, unless the
/// scans show that they have another meaning (inverted, or of the camera). For every `wish`, a warning reports such a meaning.
/// Throws InputError if `wish` is loam and the drive has no scans, or if odometry fails and there are no given poses.
PoseChoice choose_poses(const Drive& drive, const job::PosesFrom& wish, const odometry::OdometryOptions& options,
                        Progress& progress);

/// Returns the chosen trajectory, in its own world.
const Trajectory& trajectory_of(const Drive& drive, const PoseChoice& choice);

/// Aligns the estimated trajectory as a whole (rotation and translation) to the given poses, so that drives with given poses in
/// one world remain in it. Returns it unchanged if no given pose covers its times.
Trajectory align_to_given(const Trajectory& given, const Trajectory& odometry);

}  // namespace dvi::inputs
