#include "dvi/result/report_json.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/json_optional.h"
#include "dvi/core/json_text.h"
#include "dvi/inputs/reports_json.h"
#include "dvi/metrics/evaluation.h"

template <>
struct nlohmann::adl_serializer<dvi::regularize::Energies> {
  static void to_json(nlohmann::json& json, const dvi::regularize::Energies& energy) {
    json = {{"before", energy.before}, {"after", energy.after}};
  }
  static void from_json(const nlohmann::json& json, dvi::regularize::Energies& energy) {
    energy = {json.at("before"), json.at("after")};
  }
};

template <>
struct nlohmann::adl_serializer<dvi::FoundPlace> {
  static void to_json(nlohmann::json& json, const dvi::FoundPlace& found) { json = dvi::result::json_of(found); }
  static void from_json(const nlohmann::json& json, dvi::FoundPlace& found) {
    found = {{json.at("latitude_deg"), json.at("longitude_deg"), json.at("heading_deg")},
             json.at("fixes"),
             json.at("residual_m"),
             json.at("heading_bound_deg")};
  }
};

namespace dvi::result {

using nlohmann::json;

// Fields are named as the keys.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HoleParts, copied, copied_elsewhere, interpolated, synthesized, empty, unobserved)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameAlignmentReport, rotation_deg, position_m, offset_before_px, offset_after_px, points)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DriveAlignmentReport, kept, mounting_deg)

json json_of(const FoundPlace& found) {
  return {{"latitude_deg", found.place.latitude_deg}, {"longitude_deg", found.place.longitude_deg},
          {"heading_deg", found.place.heading_deg},   {"heading_bound_deg", found.heading_bound_deg},
          {"residual_m", found.residual_m},           {"fixes", found.fixes}};
}

void to_json(json& j, const HoleReport& hole) {
  j = {{"pixels", hole.pixels},
       {"copied", hole.copied},
       {"copied_elsewhere", hole.copied_elsewhere},
       {"interpolated", hole.interpolated},
       {"synthesized", hole.synthesized},
       {"empty", hole.empty},
       {"share", hole.share()}};
}
void from_json(const json& j, HoleReport& hole) {
  j.at("pixels").get_to(hole.pixels);
  j.at("copied").get_to(hole.copied);
  j.at("copied_elsewhere").get_to(hole.copied_elsewhere);
  j.at("interpolated").get_to(hole.interpolated);
  j.at("synthesized").get_to(hole.synthesized);
  j.at("empty").get_to(hole.empty);
}

void to_json(json& j, const MapReport& map) {
  const map::MapCounts& c = map.counts;
  j = {{"points", map.points},
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
void from_json(const json& j, MapReport& map) {
  map::MapCounts& c = map.counts;
  j.at("points").get_to(map.points);
  j.at("scans").get_to(c.scans);
  j.at("scans_without_pose").get_to(c.scans_without_pose);
  j.at("returns").get_to(c.returns);
  const json& dropped = j.at("dropped");
  dropped.at("in_masks").get_to(c.masked);
  dropped.at("in_boxes").get_to(c.boxed);
  dropped.at("moved").get_to(c.moved);
  dropped.at("unseen_by_camera").get_to(c.unseen_by_camera);
  dropped.at("out_of_range").get_to(c.too_near);
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameReport, number, name, hole, energy, alignment, exposure_gain)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CameraReport, camera, masks, gray, frames, alignment, warnings)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RegistrationReport, target_from_source, overlap, residual_m, bound_m, bound_deg, things,
                                   things_agree, passed_share, rival)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DriveReport, path, format, camera, frames, scans, poses, place, registration, alignment,
                                   warnings, other_cameras)

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

void to_json(json& j, const CostReport& cost) {
  const double n = static_cast<double>(std::max<std::size_t>(cost.frames_made, 1));
  json fill = json::object();
  for (const auto& [stage, seconds] : cost.fill_cpu_seconds)
    fill[stage] = {{"cpu_seconds", seconds}, {"cpu_seconds_per_frame", seconds / n}};
  j = {{"stages", stages_json(cost.stages, "frame", cost.frames_made)},
       {"fill", fill},
       {"frames_made", cost.frames_made},
       {"peak_memory_bytes", cost.peak_memory_bytes}};
}
void from_json(const json& j, CostReport& cost) {
  for (const json& stage : j.at("stages"))
    cost.stages.push_back({stage.at("stage"), stage.at("seconds"), stage.at("cpu_seconds")});
  for (const auto& [stage, seconds] : j.at("fill").items()) cost.fill_cpu_seconds[stage] = seconds.at("cpu_seconds");
  j.at("frames_made").get_to(cost.frames_made);
  j.at("peak_memory_bytes").get_to(cost.peak_memory_bytes);
}

namespace {

constexpr const char* kReportSchema = "dvi-report/1";

void to_json(json& j, const RunReport& report) {
  j = {{"schema", kReportSchema},       {"version", report.version},       {"method", report.method},
       {"baseline", report.baseline},   {"drives", report.drives},         {"hole", report.hole},
       {"artifacts", report.artifacts}, {"stationary", report.stationary}, {"map", report.map},
       {"cost", report.cost},           {"warnings", report.warnings},     {"frames", report.frames}};
}
void from_json(const json& j, RunReport& report) {
  j.at("version").get_to(report.version);
  j.at("method").get_to(report.method);
  j.at("baseline").get_to(report.baseline);
  j.at("drives").get_to(report.drives);
  j.at("hole").get_to(report.hole);
  j.at("artifacts").get_to(report.artifacts);
  j.at("stationary").get_to(report.stationary);
  j.at("map").get_to(report.map);
  j.at("cost").get_to(report.cost);
  j.at("warnings").get_to(report.warnings);
  j.at("frames").get_to(report.frames);
}

}  // namespace

json json_of(const FrameReport& report) { return report; }
json json_of(const HoleReport& hole) { return hole; }
FrameReport frame_of(const json& j) { return j.get<FrameReport>(); }

std::string to_json(const RunReport& report) {
  json document;
  to_json(document, report);
  return json_text(document);
}

std::optional<RunReport> read_run_report(const fs::path& file) {
  if (!fs::is_regular_file(file)) return std::nullopt;
  try {
    RunReport report;
    from_json(json::parse(read_file(file)), report);
    return report;
  } catch (const json::exception&) {  // answered: cut by a crash, or by hand
    return std::nullopt;
  }
}

}  // namespace dvi::result
