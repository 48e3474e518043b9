#include "dvi/inputs/poses_report.h"

#include <algorithm>

#include "dvi/inputs/stretches.h"

namespace dvi::inputs {
namespace {

std::optional<SharpnessReport> sharpness_report(const std::optional<odometry::Sharpness>& s) {
  if (!s) return std::nullopt;
  return SharpnessReport{s->ground_m, s->vertical_m, s->ground_patches, s->vertical_patches};
}

std::optional<LengthReport> spread(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  return LengthReport{values[values.size() / 2], values.back()};
}

/// How far the odometry's motion over 10 m is from the given poses'.
std::optional<MotionReport> against_given(const std::vector<StampedPose>& poses, const Trajectory& given) {
  constexpr double kWay = 10;
  std::vector<double> meters, degrees;
  std::size_t last = 0;
  double way = 0;
  for (std::size_t first = 0; first < poses.size(); ++first) {
    for (; last + 1 < poses.size() && way < kWay; ++last)
      way += (poses[last + 1].world_from_body.t - poses[last].world_from_body.t).norm();
    const std::optional<SE3> a = given.at(poses[first].time_ns), b = given.at(poses[last].time_ns);
    if (way >= kWay && a && b) {
      const SE3 off = (poses[first].world_from_body.inverse() * poses[last].world_from_body).inverse() * (a->inverse() * *b);
      meters.push_back(off.t.norm());
      degrees.push_back(so3_log(off.R).norm() * 180 / M_PI);
    }
    if (first < last) way -= (poses[first + 1].world_from_body.t - poses[first].world_from_body.t).norm();
  }
  const std::optional<LengthReport> m = spread(meters), deg = spread(degrees);
  if (!m) return std::nullopt;
  return MotionReport{m->median_m, m->largest_m, deg->median_m, deg->largest_m};
}

DriftReport drift_report(const odometry::Odometry& odometry, const Trajectory& given) {
  std::vector<double> lag_correction;
  for (const odometry::ScanFit& fit : odometry.scans)
    if (fit.state == odometry::ScanFit::State::registered) lag_correction.push_back(fit.lag_correction_m);
  return {spread(lag_correction), against_given(odometry.world_from_lidar.poses(), given), odometry.loops,
          odometry.largest_correction_m};
}

ScanReport scan_report(const odometry::ScanFit& fit) {
  return {.state = odometry::to_string(fit.state),
          .guess = fit.given ? "given" : "motion",
          .features = fit.features,
          .inliers = fit.inliers,
          .residual_m = fit.residual_m,
          .lag_correction_m = fit.lag_correction_m,
          .degenerate_directions = fit.degenerate};
}

OdometryReport odometry_report(const odometry::Odometry& odometry, const Trajectory& given) {
  OdometryReport out{.rings = odometry.rings,
                     .plane_features = odometry.plane_features,
                     .edge_features = odometry.edge_features,
                     .drift = drift_report(odometry, given),
                     .scans = {}};
  out.path_m = path_length_m(odometry.world_from_lidar.poses());
  for (const odometry::ScanFit& fit : odometry.scans) out.scans.push_back(scan_report(fit));
  return out;
}

}  // namespace

PosesReport poses_report(const Drive& drive, const PoseChoice& choice) {
  PosesReport out{to_string(choice.from), sharpness_report(choice.given), sharpness_report(choice.loam), {}};
  if (choice.odometry) out.odometry = odometry_report(*choice.odometry, drive.poses);
  return out;
}

}  // namespace dvi::inputs
