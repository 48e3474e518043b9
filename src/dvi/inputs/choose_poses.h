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

/// Where a drive's poses come from, and how sharp a map they make.
struct PoseChoice {
  PoseOrigin from = PoseOrigin::given;
  std::optional<odometry::Odometry> odometry;
  std::optional<odometry::Sharpness> given, loam;
  std::vector<diagnostics::ScanTrack> tracks;       ///< what the poses are held against
  std::optional<diagnostics::PoseReading> misread;  ///< the given poses mean something else; then they are no guess
  std::vector<std::string> warnings;                ///< that they are, and maps that hold too little to be judged
};

/// automatic: the given poses or those of the scans, which take the given motion for a guess, whichever lay the scans together
/// more sharply; the given ones where they are as good, unless the scans show that they mean something else. Whatever is wished
/// for, a warning says if they do. InputError where loam is wished for and there are no scans.
PoseChoice choose_poses(const Drive& drive, const job::PosesFrom& wish, const odometry::OdometryOptions& options,
                        Progress& progress);

/// The trajectory that was chosen, in its own world.
const Trajectory& chosen(const Drive& drive, const PoseChoice& choice);

/// The odometry's motion, laid onto the given poses as a whole where there are some: drives that share a world stay together.
Trajectory laid_onto(const Trajectory& given, const Trajectory& odometry);

}  // namespace dvi::inputs
