#include <nlohmann/json.hpp>

#include "dvi/eval/evaluation.h"

namespace dvi {

static void to_json(nlohmann::json& json, const Figures& f) {
  json = {{"frames", f.frames},   {"pixels", f.pixels},
          {"share", f.share},     {"mae", f.mae},
          {"rmse", f.rmse},       {"psnr", f.psnr},
          {"ssim", f.ssim},       {"sharpness", f.sharpness},
          {"flicker", f.flicker}, {"misplaced_px", f.misplaced_px}};
}

static void to_json(nlohmann::json& json, const ByOrigin& figures) {
  json = nlohmann::json::object();
  for (const Origin origin : kOrigins) json[name(origin)] = figures[origin];
}

static void to_json(nlohmann::json& json, const FrameEvaluation& frame) {
  json = frame.figures;
  json["name"] = frame.name;
}

void to_json(nlohmann::json& json, const Evaluation& evaluation) {
  json = evaluation.total;
  json["version"] = 1;
  json["per_frame"] = evaluation.frames;
  json["unscored"] = evaluation.unscored;
  json["warnings"] = evaluation.warnings;
}

}  // namespace dvi
