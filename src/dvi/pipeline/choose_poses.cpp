#include "dvi/pipeline/choose_poses.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::pipeline {
namespace {

// Poses from the scans must be better by more metres than this: below, the measure cannot tell, and given poses hold over long
// drives.
constexpr double kSharper = 0.002;

}  // namespace

PoseChoice choose_poses(const Drive& drive, const PosesFrom& wish, const odometry::OdometryOptions& options,
                        Progress& progress) {
  PoseChoice choice;
  const bool automatic = wish.kind == PosesFrom::Kind::automatic, loam = wish.kind == PosesFrom::Kind::loam;
  if (loam && drive.scan_headers.empty()) throw InputError(drive.path, "has no scans", "--poses loam needs them");
  if (!loam && (!automatic || drive.scan_headers.empty())) return choice;
  const std::string name = drive.path.filename().string();
  choice.odometry = odometry::odometry(drive, options, automatic ? drive.poses : Trajectory(), progress.parts());
  for (const std::string& warning : choice.odometry->warnings) progress.warn(name + ": " + warning);
  if (choice.odometry->loops > 0)
    progress.note(fmt::format("{}: {} loops closed, poses moved by up to {:.2f} m", name, choice.odometry->loops,
                              choice.odometry->largest_correction_m));
  if (choice.odometry->world_from_lidar.empty()) {
    if (loam || drive.poses.empty()) throw InputError(drive.path, "has no scan that odometry could hold on to");
    return choice;
  }
  const bool both = automatic && !drive.poses.empty();
  progress.begin("sharpness", (both ? 2 : 1) * odometry::sharpness_ticks(drive));
  choice.loam = odometry::sharpness(drive, choice.odometry->world_from_lidar, progress.tick());
  if (both) choice.given = odometry::sharpness(drive, drive.poses, progress.tick());
  const bool lost = std::any_of(choice.odometry->scans.begin(), choice.odometry->scans.end(),
                                [](const odometry::ScanFit& fit) { return fit.state == odometry::ScanFit::State::lost; });
  const bool sharper = both && !lost && choice.loam->known() && choice.loam->total_m() + kSharper < choice.given->total_m();
  if (!both || sharper) choice.from = PoseOrigin::loam;
  progress.end();
  return choice;
}

const Trajectory& chosen(const Drive& drive, const PoseChoice& choice) {
  return choice.from == PoseOrigin::loam ? choice.odometry->world_from_lidar : drive.poses;
}

Trajectory laid_onto(const Trajectory& given, const Trajectory& odometry) {
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

}  // namespace dvi::pipeline
