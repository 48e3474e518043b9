#include "dvi/pipeline/report.h"

#include <array>
#include <numbers>

#include <nlohmann/json.hpp>

namespace dvi::pipeline {
namespace {

const std::array<const char*, 6> kKinds{"original", "copied", "copied_elsewhere", "interpolated", "synthesised", "empty"};

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

std::array<float, 3> rgb(const cv::Vec3f& bgr) { return {bgr[2], bgr[1], bgr[0]}; }

// Shares of the hole; never_seen is what no other frame had, whatever then became of it.
void add_shares(nlohmann::json& hole) {
  const double pixels = hole["pixels"].get<double>();
  nlohmann::json& share = hole["share"];
  for (std::size_t k = 1; k < kKinds.size(); ++k) share[kKinds[k]] = pixels > 0 ? hole[kKinds[k]].get<double>() / pixels : 0.0;
  share["never_seen"] = share["interpolated"].get<double>() + share["synthesised"].get<double>() + share["empty"].get<double>();
}

nlohmann::json in_degrees(const Eigen::Vector3d& rotation) {
  return {degrees(rotation.x()), degrees(rotation.y()), degrees(rotation.z())};
}

nlohmann::json alignment_report(const align::DriveAlignment& drive) {
  return {{"kept", drive.kept}, {"mounting_deg", in_degrees(drive.mounting)}};
}

}  // namespace

nlohmann::json frame_report(const Frame& frame, const FilledView& view, const align::ViewAlignment& alignment) {
  std::array<std::size_t, 6> count{};
  for (const uchar kind : view.frame.kind) ++count[std::min<std::size_t>(kind, 5)];
  nlohmann::json hole;
  std::size_t pixels = 0;
  for (std::size_t k = 1; k < kKinds.size(); ++k) {
    hole[kKinds[k]] = count[k];
    pixels += count[k];
  }
  hole["pixels"] = pixels;
  add_shares(hole);
  return {{"number", frame.number},
          {"name", frame.name},
          {"hole", hole},
          {"energy", {{"before", view.energy_before}, {"after", view.energy_after}}},
          {"alignment",
           {{"rotation_deg", in_degrees(alignment.rotation)},
            {"offset_before_px", alignment.offset_before_px},
            {"offset_after_px", alignment.offset_after_px},
            {"points", alignment.points}}},
          {"exposure_gain", rgb(view.frame.gain)}};
}

nlohmann::json hole_report(const std::vector<nlohmann::json>& frames) {
  nlohmann::json hole;
  for (const char* kind : kKinds)
    if (kind != kKinds[0]) hole[kind] = 0;
  hole["pixels"] = 0;
  for (const nlohmann::json& frame : frames)
    for (auto& [key, value] : hole.items()) value = value.get<std::size_t>() + frame["hole"][key].get<std::size_t>();
  add_shares(hole);
  return hole;
}

nlohmann::json map_report(const map::StaticMap& map) {
  const map::MapCounts& c = map.counts;
  return {{"points", map.points.size()},
          {"sweeps", c.sweeps},
          {"sweeps_without_pose", c.sweeps_without_pose},
          {"returns", c.returns},
          {"dropped",
           {{"in_masks", c.masked},
            {"in_boxes", c.boxed},
            {"moved", c.moved},
            {"not_witnessed", c.unwitnessed},
            {"out_of_range", c.too_near}}}};
}

nlohmann::json drives_report(const std::vector<OpenDrive>& drives, const std::vector<align::DriveAlignment>& alignment) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const OpenDrive& open = drives[i];
    out.push_back({{"path", fs::absolute(open.drive.path).lexically_normal().string()},
                   {"format", open.drive.format},
                   {"camera", open.drive.camera_name},
                   {"frames", open.drive.frames.size()},
                   {"sweeps", open.drive.sweeps.size()},
                   {"poses", poses_report(open.drive, open.poses)},
                   {"alignment", i < alignment.size() ? alignment_report(alignment[i]) : nlohmann::json()},
                   {"warnings", open.drive.warnings}});
  }
  return out;
}

nlohmann::json sources_report(const Views& views, const std::vector<OpenDrive>& drives) {
  nlohmann::json sources = nlohmann::json::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Drive& drive = drives[static_cast<std::size_t>(views[i].drive)].drive;
    const Frame& frame = drive.frames[views[i].frame];
    sources.push_back({{"number", i},
                       {"drive", fs::absolute(drive.path).lexically_normal().string()},
                       {"camera", drive.camera_name},
                       {"frame", frame.name},
                       {"file", fs::absolute(frame.file).lexically_normal().string()},
                       {"exposure_gain", rgb(views[i].gain)}});
  }
  return {{"schema", "dvi-sources/1"}, {"sources", sources}};
}

nlohmann::json stages_report(const Progress& progress, const std::string& unit, std::size_t count) {
  nlohmann::json stages = nlohmann::json::array();
  const double n = static_cast<double>(std::max<std::size_t>(count, 1));
  for (const StageTime& t : progress.times())
    stages.push_back({{"stage", t.stage},
                      {"seconds", t.seconds},
                      {"cpu_seconds", t.cpu_seconds},
                      {"cpu_seconds_per_" + unit, t.cpu_seconds / n}});
  return stages;
}

nlohmann::json cost_report(const Progress& progress, const CpuClock& clock, std::size_t frames) {
  const double n = static_cast<double>(std::max<std::size_t>(frames, 1));
  nlohmann::json fill = nlohmann::json::object();
  for (const auto& [stage, seconds] : clock.seconds())
    fill[stage] = {{"cpu_seconds", seconds}, {"cpu_seconds_per_frame", seconds / n}};
  return {{"stages", stages_report(progress, "frame", frames)},
          {"fill", fill},
          {"frames_made", frames},
          {"peak_memory_bytes", peak_memory()}};
}

}  // namespace dvi::pipeline
