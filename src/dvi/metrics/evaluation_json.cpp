#include <cstddef>
#include <optional>

#include <nlohmann/json.hpp>

#include "dvi/core/json_optional.h"
#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {

static void to_json(nlohmann::json& json, const Figures& f) {
  json = {{"frames", f.frames},   {"pixels", f.pixels},
          {"share", f.share},     {"mae", f.mae},
          {"rmse", f.rmse},       {"psnr", f.psnr},
          {"ssim", f.ssim},       {"sharpness", f.sharpness},
          {"flicker", f.flicker}, {"misplaced_px", f.position_error_px}};
}

static void to_json(nlohmann::json& json, const ByOrigin& figures) {
  json = nlohmann::json::object();
  for (const Origin origin : kOrigins) json[name(origin)] = figures[origin];
}

static void to_json(nlohmann::json& json, const FrameEvaluation& frame) {
  json = frame.figures;
  json["name"] = frame.name;
}

static nlohmann::json to_document(const std::optional<Intervals>& intervals) {
  if (!intervals) return nullptr;
  return {{"mae", intervals->mae},
          {"rmse", intervals->rmse},
          {"psnr", intervals->psnr},
          {"ssim", intervals->ssim},
          {"sharpness", intervals->sharpness}};
}

static void to_json(nlohmann::json& json, const Calibration::Decile& decile) {
  json = {{"confidence", decile.confidence}, {"within", decile.within}, {"mae", decile.mae}, {"pixels", decile.pixels}};
}

static nlohmann::json to_document(const std::optional<Calibration>& confidence) {
  if (!confidence) return nullptr;
  return {{"pixels", confidence->pixels}, {"mean", confidence->mean}, {"within", confidence->within},
          {"ece", confidence->ece},       {"ause", confidence->ause}, {"deciles", confidence->deciles}};
}

static nlohmann::json to_confidence_json(const Evaluation& evaluation) {
  nlohmann::json json = to_document(evaluation.confidence.front());
  for (std::size_t i = 1; !json.is_null() && i < kOrigins.size(); ++i)
    json["by_kind"][name(kOrigins[i])] = to_document(evaluation.confidence[i]);
  return json;
}

static nlohmann::json to_whole_frame_json(const Figures& f) {
  return {{"mae", f.mae}, {"rmse", f.rmse}, {"psnr", f.psnr}, {"ssim", f.ssim}};
}

void to_json(nlohmann::json& json, const Artifacts& a) {
  json = {{"flash_ppm", a.flash_ppm()}, {"flash_ring_ppm", a.ring_flash_ppm()}, {"overshoot_ppm", a.overshoot_ppm()},
          {"hole_pixels", a.hole},      {"hole_between", a.hole_between},       {"ring_between", a.ring_between},
          {"flashes", a.flashes},       {"ring_flashes", a.ring_flashes},       {"overshoots", a.overshoots}};
}

static void to_json(nlohmann::json& json, const LookSums& sums) {
  json = {{"pixels", sums.pixels},       {"judged_pixels", sums.judged}, {"look", sums.look()},   {"texture", sums.texture()},
          {"boundary", sums.boundary()}, {"blank", sums.blank()},        {"color", sums.color()}, {"impact", sums.impact()}};
}

static void to_json(nlohmann::json& json, const LookFrame& frame) {
  json = frame.sums;
  json["name"] = frame.name;
}

static void to_json(nlohmann::json& json, const LookPart& part) {
  json = part.sums;
  json["frame"] = part.frame;
  json["box"] = {part.box.x, part.box.y, part.box.width, part.box.height};
}

void to_json(nlohmann::json& json, const Look& look) {
  json = look.total;
  json["per_frame"] = look.frames;
  json["worst_frames"] = look.find_worst_frames();
  json["worst_parts"] = look.find_worst_parts();
}

static void to_json(nlohmann::json& json, const GhostCounts& counts) {
  json = {{"copied", counts.copied},
          {"ghosts", counts.ghosts},
          {"in_map", counts.in_map},
          {"ghost_share", counts.ghost_share()},
          {"in_map_share", counts.in_map_share()}};
}

static void to_json(nlohmann::json& json, const GhostFrame& frame) {
  json = frame.counts;
  json["name"] = frame.name;
}

static void to_json(nlohmann::json& json, const GhostTrack& track) {
  json = {{"track", track.track},
          {"class", track.type},
          {"removed", track.removed},
          {"refilled", track.refilled},
          {"refilled_share", track.refilled_share()}};
}

void to_json(nlohmann::json& json, const Ghosts& ghosts) {
  json = ghosts.total;
  json["not_judged"] = ghosts.unjudged;
  json["stationary_tracks"] = ghosts.tracks.size();
  json["tracks"] = ghosts.tracks;
  json["per_frame"] = ghosts.frames;
  json["worst_frames"] = ghosts.find_worst_frames();
}

static void to_json(nlohmann::json& json, const PointCounts& counts) {
  json = {{"static", counts.statics},           {"labeled_static", counts.labeled_static},
          {"dynamic", counts.dynamics},         {"labeled_dynamic", counts.labeled_dynamic},
          {"sa", counts.static_accuracy()},     {"da", counts.dynamic_accuracy()},
          {"aa", counts.associated_accuracy()}, {"iou", counts.dynamic_iou()}};
}

static void to_json(nlohmann::json& json, const PointScores& points) {
  json = {{"scans", points.scans}, {"all", points.all}, {"in_view", points.in_view}};
}

void to_json(nlohmann::json& json, const Evaluation& evaluation) {
  json = nlohmann::json::object();
  if (evaluation.has_truth) {
    json = evaluation.total;
    for (const Origin origin : kOrigins)
      json[name(origin)]["interval"] = to_document(evaluation.intervals[static_cast<std::size_t>(origin)]);
    json["whole_frame"] = to_whole_frame_json(evaluation.whole_frame);
    json["confidence"] = to_confidence_json(evaluation);
    json["per_frame"] = evaluation.frames;
    json["unscored"] = evaluation.unscored;
  }
  json["version"] = 1;
  json["warnings"] = evaluation.warnings;
  json["artifacts"] = evaluation.artifacts;
  json["look"] = evaluation.look;
  json["ghosts"] = evaluation.ghosts;
  json["ghosts_left_out"] = evaluation.ghosts_left_out.empty() ? nlohmann::json() : nlohmann::json(evaluation.ghosts_left_out);
  if (evaluation.points) json["points"] = *evaluation.points;
  json["external"] = nlohmann::json::object();
  for (const ExternalEvaluation& external : evaluation.external) json["external"][external.name] = external.evaluation;
}

}  // namespace dvi::metrics
