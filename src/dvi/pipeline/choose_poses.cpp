#include "dvi/pipeline/choose_poses.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"

namespace dvi::pipeline {
namespace {

// Poses from the scans must be better by more metres than this: below, the measure cannot tell, and given poses hold over long
// drives.
constexpr double kSharper = 0.002;

nlohmann::json sharpness_report(const std::optional<odometry::Sharpness>& s) {
  if (!s) return nullptr;
  return {{"ground_m", s->ground_m},
          {"vertical_m", s->vertical_m},
          {"ground_patches", s->ground_patches},
          {"vertical_patches", s->vertical_patches}};
}

/// Middle and largest of some lengths; null where there are none.
nlohmann::json spread(std::vector<double> values, const char* unit) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  return {{fmt::format("median_{}", unit), values[values.size() / 2]}, {fmt::format("largest_{}", unit), values.back()}};
}

/// How far the odometry's motion over 10 m is from the given poses'.
nlohmann::json against_given(const std::vector<StampedPose>& poses, const Trajectory& given) {
  constexpr double kWay = 10;
  std::vector<double> metres, degrees;
  std::size_t last = 0;
  double way = 0;
  for (std::size_t first = 0; first < poses.size(); ++first) {
    for (; last + 1 < poses.size() && way < kWay; ++last)
      way += (poses[last + 1].world_from_body.t - poses[last].world_from_body.t).norm();
    const std::optional<SE3> a = given.at(poses[first].time_ns), b = given.at(poses[last].time_ns);
    if (way >= kWay && a && b) {
      const SE3 off = (poses[first].world_from_body.inverse() * poses[last].world_from_body).inverse() * (a->inverse() * *b);
      metres.push_back(off.t.norm());
      degrees.push_back(so3_log(off.R).norm() * 180 / M_PI);
    }
    if (first < last) way -= (poses[first + 1].world_from_body.t - poses[first].world_from_body.t).norm();
  }
  if (metres.empty()) return nullptr;
  nlohmann::json out = spread(metres, "m");
  out.update(spread(degrees, "deg"));
  return out;
}

/// What tells how far off the odometry's poses may be, whether there is a truth or not.
nlohmann::json drift_report(const odometry::Odometry& odometry, const Trajectory& given) {
  std::vector<double> second_look;
  for (const odometry::SweepFit& fit : odometry.sweeps)
    if (fit.state == odometry::SweepFit::State::registered) second_look.push_back(fit.second_look_m);
  return {{"second_look", spread(second_look, "m")},
          {"given_over_10_m", against_given(odometry.world_from_lidar.poses(), given)},
          {"loops", odometry.loops},
          {"largest_correction_m", odometry.largest_correction_m}};
}

nlohmann::json odometry_report(const odometry::Odometry& odometry, const Trajectory& given) {
  nlohmann::json sweeps = nlohmann::json::array();
  double path = 0;
  const auto& poses = odometry.world_from_lidar.poses();
  for (std::size_t i = 1; i < poses.size(); ++i) path += (poses[i].world_from_body.t - poses[i - 1].world_from_body.t).norm();
  for (const odometry::SweepFit& fit : odometry.sweeps)
    sweeps.push_back({{"state", odometry::to_string(fit.state)},
                      {"features", fit.features},
                      {"inliers", fit.inliers},
                      {"residual_m", fit.residual_m},
                      {"degenerate_directions", fit.degenerate},
                      {"guess", fit.given ? "given" : "motion"},
                      {"second_look_m", fit.second_look_m}});
  return {{"rings", odometry.rings},
          {"path_m", path},
          {"plane_features", odometry.plane_features},
          {"edge_features", odometry.edge_features},
          {"drift", drift_report(odometry, given)},
          {"sweeps", sweeps}};
}

}  // namespace

PoseChoice choose_poses(const Drive& drive, const std::string& wish, const odometry::OdometryOptions& options,
                        Progress& progress) {
  PoseChoice choice;
  if (wish == "loam" && drive.sweeps.empty()) throw InputError(drive.path, "has no scans", "--poses loam needs them");
  if (wish != "loam" && (wish != "auto" || drive.sweeps.empty())) return choice;
  const std::string name = drive.path.filename().string();
  choice.odometry = odometry::odometry(drive, options, wish == "auto" ? drive.poses : Trajectory(), progress.parts());
  for (const std::string& warning : choice.odometry->warnings) progress.warn(name + ": " + warning);
  if (choice.odometry->loops > 0)
    progress.note(fmt::format("{}: {} loops closed, poses moved by up to {:.2f} m", name, choice.odometry->loops,
                              choice.odometry->largest_correction_m));
  if (choice.odometry->world_from_lidar.empty()) {
    if (wish == "loam" || drive.poses.empty()) throw InputError(drive.path, "has no scan that odometry could hold on to");
    return choice;
  }
  const bool both = wish == "auto" && !drive.poses.empty();
  progress.begin("sharpness", (both ? 2 : 1) * odometry::sharpness_ticks(drive));
  choice.loam = odometry::sharpness(drive, choice.odometry->world_from_lidar, progress.tick());
  if (both) choice.given = odometry::sharpness(drive, drive.poses, progress.tick());
  const bool lost = std::any_of(choice.odometry->sweeps.begin(), choice.odometry->sweeps.end(),
                                [](const odometry::SweepFit& fit) { return fit.state == odometry::SweepFit::State::lost; });
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

nlohmann::json poses_report(const Drive& drive, const PoseChoice& choice) {
  return {{"from", choice.from},
          {"sharpness", {{"given", sharpness_report(choice.given)}, {"loam", sharpness_report(choice.loam)}}},
          {"odometry", choice.odometry ? odometry_report(*choice.odometry, drive.poses) : nlohmann::json()}};
}

}  // namespace dvi::pipeline
