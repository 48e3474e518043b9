#include "dvi/inputs/choose_poses.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/inputs/stretches.h"

namespace dvi::inputs {
namespace {

// Smaller gains in sharpness are below the accuracy of the measure, and given poses do not drift over long drives.
constexpr double kMinGainM = 0.002;
// A trajectory that aligns a smaller share of the other one's patches blurs the rest, so its patches do not represent its map.
constexpr double kMinPatchShare = 0.5;

std::size_t count_patches(const odometry::Sharpness& map) { return map.ground_patches + map.vertical_patches; }

bool has_support(const odometry::Sharpness& map, const odometry::Sharpness& other) {
  return map.known() && static_cast<double>(count_patches(map)) >= kMinPatchShare * static_cast<double>(count_patches(other));
}

/// Whether the poses estimated from the scans make a sharper map than the given ones.
bool is_loam_sharper(const odometry::Sharpness& loam, const odometry::Sharpness& given) {
  if (!has_support(loam, given)) return false;
  return !has_support(given, loam) || loam.total_m() + kMinGainM < given.total_m();
}

void check_given_poses(const Drive& drive, const odometry::OdometryOptions& options, Progress& progress, PoseChoice& choice) {
  progress.begin("plausibility", diagnostics::count_scan_track_ticks(drive));
  choice.tracks = diagnostics::estimate_scan_tracks(drive, options, progress.tick());
  choice.misread = diagnostics::find_better_reading(drive.poses, drive.camera_from_lidar, choice.tracks);
  if (choice.misread) choice.warnings.push_back(choice.misread->words);
  progress.end();
}

enum class Compared { loam, both };

void compare_sharpness(const Drive& drive, Compared compared, Progress& progress, PoseChoice& choice) {
  const bool both = compared == Compared::both;
  progress.begin("sharpness", (both ? 2 : 1) * odometry::count_sharpness_ticks(drive));
  const Tick tick = progress.tick();
  parallel_for(both ? 2 : 1, [&](std::size_t k) {
    (k == 0 ? choice.loam : choice.given) =
        odometry::measure_sharpness(drive, k == 0 ? choice.odometry->world_from_lidar : drive.poses, tick);
  });
  progress.end();
  if (both && !has_support(*choice.given, *choice.loam) && choice.loam->known())
    choice.warnings.push_back(
        fmt::format("the given poses align {} flat patches of the scans, and poses estimated from the scans align {}: the "
                    "given poses do not align the scans",
                    count_patches(*choice.given), count_patches(*choice.loam)));
}

/// Whether most scans of a depth camera have no pose, so that the others show too little of the recording.
bool is_mostly_lost(const Drive& drive, const odometry::Odometry& odometry) {
  constexpr double kMaxLostShare = 0.5;
  const auto lost = std::count_if(odometry.scans.begin(), odometry.scans.end(),
                                  [](const odometry::ScanFit& fit) { return fit.state == odometry::ScanFit::State::lost; });
  return drive.sensor == Sensor::depth_camera &&
         static_cast<double>(lost) > kMaxLostShare * static_cast<double>(odometry.scans.size());
}

/// Whether given poses can be compared with poses estimated from the scans. One pose does not determine the motion within a
/// scan, and poses on another clock cover no frame.
bool can_compare_given(const Drive& drive) {
  return drive.poses.poses().size() > 1 && std::any_of(drive.frames.begin(), drive.frames.end(), [&](const Frame& frame) {
           return drive.poses.at(frame.time_ns).has_value();
         });
}

PoseChoice compare_sources(const Drive& drive, const job::PosesFrom& wish, const odometry::OdometryOptions& options,
                           Progress& progress) {
  PoseChoice choice;
  const bool automatic = wish.kind == job::PosesFrom::Kind::automatic, loam = wish.kind == job::PosesFrom::Kind::loam;
  if (loam && drive.scan_headers.empty()) throw InputError(drive.path, "has no scans", "--poses loam needs them");
  check_given_poses(drive, options, progress, choice);
  if (!loam && (!automatic || drive.scan_headers.empty())) return choice;
  const bool guess = automatic && !choice.misread;
  choice.odometry = estimate_odometry(drive, options, guess ? drive.poses : Trajectory(), progress);
  choice.warnings.insert(choice.warnings.end(), choice.odometry->warnings.begin(), choice.odometry->warnings.end());
  if (choice.odometry->loops > 0)
    progress.note(fmt::format("{}: {} loops closed, poses moved by up to {:.2f} m", drive.path.filename().string(),
                              choice.odometry->loops, choice.odometry->largest_correction_m));
  if (choice.odometry->world_from_lidar.empty()) {
    if (loam || drive.poses.empty()) throw InputError(drive.path, "has no scan that odometry can align");
    return choice;
  }
  if (is_mostly_lost(drive, *choice.odometry)) {
    if (!loam && !drive.poses.empty()) return choice;
    throw InputError(
        drive.path,
        choice.odometry->warnings.empty() ? "has too few scans that odometry can align" : choice.odometry->warnings.back(),
        "give poses (--poses FILE), or record more slowly, in better light, and closer to objects with texture");
  }
  const bool both = automatic && can_compare_given(drive);
  compare_sharpness(drive, both ? Compared::both : Compared::loam, progress, choice);
  const bool lost = std::any_of(choice.odometry->scans.begin(), choice.odometry->scans.end(),
                                [](const odometry::ScanFit& fit) { return fit.state == odometry::ScanFit::State::lost; });
  if (!both || choice.misread || (!lost && is_loam_sharper(*choice.loam, *choice.given))) choice.from = PoseOrigin::loam;
  return choice;
}

}  // namespace

PoseChoice choose_poses(const Drive& drive, const job::PosesFrom& wish, const odometry::OdometryOptions& options,
                        Progress& progress) {
  PoseChoice choice = compare_sources(drive, wish, options, progress);
  for (const std::string& warning : choice.warnings) progress.warn(drive.path.filename().string() + ": " + warning);
  return choice;
}

const Trajectory& trajectory_of(const Drive& drive, const PoseChoice& choice) {
  return choice.from == PoseOrigin::loam ? choice.odometry->world_from_lidar : drive.poses;
}

Trajectory align_to_given(const Trajectory& given, const Trajectory& odometry) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_given = Eigen::Vector3d::Zero(), mean_odometry = Eigen::Vector3d::Zero();
  double n = 0;
  for (const StampedPose& p : odometry.poses()) {
    const std::optional<SE3> at = given.at(p.time_ns);
    if (!at) continue;
    turn += at->R * p.world_from_body.R.transpose();
    mean_given += at->t, mean_odometry += p.world_from_body.t, n += 1;
  }
  if (n == 0) return odometry;
  const Eigen::Matrix3d R = nearest_rotation(turn);
  return odometry.in({R, (mean_given - R * mean_odometry) / n});
}

}  // namespace dvi::inputs
