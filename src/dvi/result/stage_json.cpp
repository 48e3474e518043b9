#include "dvi/result/stage_json.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "dvi/geometry/angles.h"
#include "dvi/inputs/stretches.h"
#include "dvi/result/run_report.h"

namespace dvi::result {

using nlohmann::json;

namespace {

constexpr double kDegPerRad = to_degrees(1);

std::array<double, 3> array_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json sharpness_json(const std::optional<odometry::Sharpness>& s) {
  if (!s) return {};
  return {{"ground_m", s->ground_m},
          {"vertical_m", s->vertical_m},
          {"ground_patches", s->ground_patches},
          {"vertical_patches", s->vertical_patches}};
}

/// Returns the upper median and the maximum of some values.
std::optional<std::pair<double, double>> median_and_largest(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  return std::pair(values[values.size() / 2], values.back());
}

/// Compares the odometry with the given poses over 10 m of the path; null if no given poses cover it.
json deviation_json(const std::vector<StampedPose>& poses, const Trajectory& given) {
  constexpr double kPathLengthM = 10;
  std::vector<double> meters, degrees;
  std::size_t last = 0;
  double length = 0;
  for (std::size_t first = 0; first < poses.size(); ++first) {
    for (; last + 1 < poses.size() && length < kPathLengthM; ++last)
      length += (poses[last + 1].world_from_body.t - poses[last].world_from_body.t).norm();
    const std::optional<SE3> a = given.at(poses[first].time_ns), b = given.at(poses[last].time_ns);
    if (length >= kPathLengthM && a && b) {
      const SE3 off = (poses[first].world_from_body.inverse() * poses[last].world_from_body).inverse() * (a->inverse() * *b);
      meters.push_back(off.t.norm());
      degrees.push_back(to_degrees(so3_log(off.R).norm()));
    }
    if (first < last) length -= (poses[first + 1].world_from_body.t - poses[first].world_from_body.t).norm();
  }
  const auto m = median_and_largest(meters), deg = median_and_largest(degrees);
  if (!m) return {};
  return {{"median_m", m->first}, {"largest_m", m->second}, {"median_deg", deg->first}, {"largest_deg", deg->second}};
}

json lag_correction_json(const std::vector<odometry::ScanFit>& scans) {
  std::vector<double> corrections;
  for (const odometry::ScanFit& fit : scans)
    if (fit.state == odometry::ScanFit::State::registered) corrections.push_back(fit.lag_correction_m);
  const auto m = median_and_largest(corrections);
  if (!m) return {};
  return {{"median_m", m->first}, {"largest_m", m->second}};
}

json scan_json(const odometry::ScanFit& fit) {
  return {{"state", odometry::to_string(fit.state)},
          {"guess", fit.given ? "given" : "motion"},
          {"features", fit.features},
          {"inliers", fit.inliers},
          {"residual_m", fit.residual_m},
          {"lag_correction_m", fit.lag_correction_m},
          {"degenerate_directions", fit.degenerate}};
}

json odometry_json(const std::optional<odometry::Odometry>& odometry, const Trajectory& given) {
  if (!odometry) return {};
  json scans = json::array();
  for (const odometry::ScanFit& fit : odometry->scans) scans.push_back(scan_json(fit));
  const std::vector<StampedPose>& poses = odometry->world_from_lidar.poses();
  return {{"rings", odometry->rings},
          {"path_m", inputs::path_length_m(poses)},
          {"plane_features", odometry->plane_features},
          {"edge_features", odometry->edge_features},
          {"drift",
           {{"lag_correction", lag_correction_json(odometry->scans)},
            {"given_over_10_m", deviation_json(poses, given)},
            {"loops", odometry->loops},
            {"largest_correction_m", odometry->largest_correction_m}}},
          {"scans", scans}};
}

/// Returns the figures of a source drive that was registered by its scans; null for others. `target_from_source` is [R | t] of
/// its first LiDAR pose.
json registration_json(const Drive& drive, const inputs::DrivePoses& poses) {
  if (!poses.placed) return {};
  const registration::PlacementFigures& placed = *poses.placed;
  const Trajectory& trajectory = poses.world_from_lidar;
  const SE3 first = trajectory.at(drive.scan_headers.front().time_ns).value_or(trajectory.poses().front().world_from_body);
  json rows = json::array();
  for (int row = 0; row < 3; ++row) rows.push_back({first.R(row, 0), first.R(row, 1), first.R(row, 2), first.t[row]});
  return {{"target_from_source", rows},
          {"overlap", placed.overlap},
          {"residual_m", placed.residual_m},
          {"bound_m", placed.bound_m},
          {"bound_deg", placed.bound_deg},
          {"landmarks", placed.landmarks},
          {"landmark_inliers", placed.landmark_inliers},
          {"passed_share", placed.passed_share},
          {"second_best_ratio", placed.second_best_ratio}};
}

json alignment_json(const align::Cameras& cameras, std::size_t sequence) {
  if (sequence >= cameras.sequences.size()) return {};
  const align::SequenceAlignment& found = cameras.sequences[sequence];
  return {{"kept", found.kept}, {"mounting_deg", array_of(found.mounting * kDegPerRad)}};
}

json energy_json(const std::optional<regularize::Energies>& energy) {
  if (!energy) return {};
  return {{"before", energy->before}, {"after", energy->after}};
}

}  // namespace

json poses_json(const Drive& drive, const inputs::PoseChoice& choice) {
  return {{"from", to_string(choice.from)},
          {"sharpness", {{"given", sharpness_json(choice.given)}, {"loam", sharpness_json(choice.loam)}}},
          {"odometry", odometry_json(choice.odometry, drive.poses)}};
}

json map_json(const map::StaticMap& map) {
  const map::MapCounts& c = map.counts;
  return {{"points", map.points.size()},
          {"scans", c.scans},
          {"scans_without_pose", c.scans_without_pose},
          {"returns", c.returns},
          {"dropped",
           {{"in_masks", c.masked},
            {"in_boxes", c.boxed},
            {"moved", c.moved},
            {"unseen_by_camera", c.unseen_by_camera},
            {"out_of_range", c.too_near}}}};
}

json drives_json(const inputs::Recordings& drives, const inputs::Poses& poses, const align::Cameras& cameras) {
  json out = json::array();
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Drive& drive = drives[i].drive;
    if (drives[i].rig_of) {
      out[*drives[i].rig_of]["other_cameras"].push_back({{"camera", drive.camera_name},
                                                         {"masks", inputs::mask_source(drives[i])},
                                                         {"gray", drives[i].gray},
                                                         {"frames", drive.frames.size()},
                                                         {"alignment", alignment_json(cameras, i)},
                                                         {"warnings", drive.warnings}});
      continue;
    }
    const std::optional<FoundPlace> place = find_place(poses[i].world_from_lidar, drive.fixes);
    out.push_back({{"path", fs::absolute(drive.path).lexically_normal().string()},
                   {"format", drive.format},
                   {"camera", drive.camera_name},
                   {"frames", drive.frames.size()},
                   {"scans", drive.scan_headers.size()},
                   {"masks", inputs::mask_source(drives[i])},
                   {"poses", poses_json(drive, poses[i].choice)},
                   {"place", place ? place_json(*place) : json()},
                   {"registration", registration_json(drive, poses[i])},
                   {"alignment", alignment_json(cameras, i)},
                   {"warnings", drive.warnings},
                   {"other_cameras", json::array()}});
  }
  return out;
}

json frame_json(const std::string& camera, const Frame& frame, const FilledView& view, const align::ViewAlignment& alignment) {
  const cv::Vec3f& gain = view.frame.gain;
  json out{{"number", frame.number},
           {"name", frame.name},
           {"hole", count_hole(view.frame.kind)},
           {"energy", energy_json(view.energy)},
           {"alignment",
            {{"rotation_deg", array_of(alignment.rotation * kDegPerRad)},
             {"position_m", array_of(alignment.position)},
             {"offset_before_px", alignment.offset_before_px},
             {"offset_after_px", alignment.offset_after_px},
             {"points", alignment.points}}},
           {"exposure_gain", {gain[2], gain[1], gain[0]}}};
  if (!camera.empty()) out["camera"] = camera;
  return out;
}

json place_json(const FoundPlace& found) {
  return {{"latitude_deg", found.place.latitude_deg}, {"longitude_deg", found.place.longitude_deg},
          {"heading_deg", found.place.heading_deg},   {"heading_bound_deg", found.heading_bound_deg},
          {"residual_m", found.residual_m},           {"fixes", found.fixes}};
}

json stages_json(const std::vector<StageTime>& stages, const std::string& unit, std::size_t count) {
  json out = json::array();
  const double n = static_cast<double>(std::max<std::size_t>(count, 1));
  for (const StageTime& t : stages)
    out.push_back({{"stage", t.stage},
                   {"seconds", t.seconds},
                   {"cpu_seconds", t.cpu_seconds},
                   {"cpu_seconds_per_" + unit, t.cpu_seconds / n}});
  return out;
}

}  // namespace dvi::result
