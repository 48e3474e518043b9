#include "dvi/geometry/camera_json.h"

#include <array>
#include <vector>

#include <nlohmann/json.hpp>

namespace dvi {

nlohmann::json to_json(const Camera& camera) {
  const Camera& c = camera;
  nlohmann::json out{{"size", {c.width, c.height}},
                     {"K", {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}},
                     {"distortion", std::vector<double>(c.coefficients().begin(), c.coefficients().end())}};
  if (c.model != CameraModel::pinhole) out["model"] = to_string(c.model);
  if (c.model == CameraModel::unified) out["xi"] = c.xi;
  return out;
}

Camera camera_from_json(const nlohmann::json& entry) {
  const auto size = entry.at("size").get<std::array<int, 2>>();
  const auto K = entry.at("K").get<std::array<double, 9>>();
  const auto distortion = entry.at("distortion").get<std::vector<double>>();
  Camera out{size[0], size[1], K[0], K[4], K[2], K[5]};
  out.set_lens(make_lens(find_camera_model(entry.value("model", "pinhole")).value_or(CameraModel::pinhole), distortion,
                         entry.value("xi", 0.0)));
  return out;
}

}  // namespace dvi
