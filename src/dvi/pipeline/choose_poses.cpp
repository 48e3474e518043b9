#include "dvi/pipeline/choose_poses.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"

namespace dvi {
namespace {

// Poses from the scans must be better by more metres than this: below, the measure cannot tell, and given poses hold over long
// drives.
constexpr double kSharper = 0.002;

nlohmann::json sharpness_report(const std::optional<Sharpness>& s) {
  if (!s) return nullptr;
  return {{"ground_m", s->ground_m},
          {"vertical_m", s->vertical_m},
          {"ground_patches", s->ground_patches},
          {"vertical_patches", s->vertical_patches}};
}

nlohmann::json odometry_report(const Odometry& odometry) {
  nlohmann::json sweeps = nlohmann::json::array();
  double path = 0;
  const auto& poses = odometry.world_from_lidar.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) path += (poses[i].world_from_body.t - poses[i - 1].world_from_body.t).norm();
  for (const SweepFit& fit : odometry.sweeps)
    sweeps.push_back({{"state", to_string(fit.state)},
                      {"features", fit.features},
                      {"inliers", fit.inliers},
                      {"residual_m", fit.residual_m},
                      {"degenerate_directions", fit.degenerate}});
  return {{"rings", odometry.rings},
          {"path_m", path},
          {"plane_features", odometry.plane_features},
          {"edge_features", odometry.edge_features},
          {"loops", odometry.loops},
          {"largest_correction_m", odometry.largest_correction_m},
          {"sweeps", sweeps}};
}

}  // namespace

PoseChoice choose_poses(const Drive& drive, const std::string& wish, const OdometryOptions& options, Progress& progress) {
  PoseChoice choice;
  if (wish == "loam" && drive.sweeps.empty()) throw InputError(drive.path, "has no scans", "--poses loam needs them");
  if (wish != "loam" && (wish != "auto" || drive.sweeps.empty())) return choice;
  const std::string name = drive.path.filename().string();
  progress.begin("odometry", drive.sweeps.size());
  choice.odometry = odometry(drive, options, progress.tick());
  for (const std::string& warning : choice.odometry->warnings) progress.warn(name + ": " + warning);
  if (choice.odometry->loops > 0)
    progress.note(fmt::format("{}: {} loops closed, poses moved by up to {:.2f} m", name, choice.odometry->loops,
                              choice.odometry->largest_correction_m));
  if (choice.odometry->world_from_lidar.empty()) {
    if (wish == "loam" || drive.poses.empty()) throw InputError(drive.path, "has no scan that odometry could hold on to");
    return choice;
  }
  const bool both = wish == "auto" && !drive.poses.empty();
  progress.begin("sharpness", (both ? 2 : 1) * sharpness_ticks(drive));
  choice.loam = sharpness(drive, choice.odometry->world_from_lidar, progress.tick());
  if (both) choice.given = sharpness(drive, drive.poses, progress.tick());
  const bool lost = std::any_of(choice.odometry->sweeps.begin(), choice.odometry->sweeps.end(),
                                [](const SweepFit& fit) { return fit.state == SweepFit::State::lost; });
  const bool sharper = both && !lost && choice.loam->known() && choice.loam->total_m() + kSharper < choice.given->total_m();
  if (!both || sharper) choice.from = "loam";
  progress.end();
  return choice;
}

const Trajectory& chosen(const Drive& drive, const PoseChoice& choice) {
  return choice.from == "loam" ? choice.odometry->world_from_lidar : drive.poses;
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

nlohmann::json poses_report(const PoseChoice& choice) {
  return {{"from", choice.from},
          {"sharpness", {{"given", sharpness_report(choice.given)}, {"loam", sharpness_report(choice.loam)}}},
          {"odometry", choice.odometry ? odometry_report(*choice.odometry) : nlohmann::json()}};
}

}  // namespace dvi
