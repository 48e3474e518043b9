#include "dvi/geometry/camera_json.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"

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
  const auto name = entry.value("model", "pinhole");
  const std::optional<CameraModel> model = find_camera_model(name);
  if (!model)
    throw InputError(fmt::format("the camera model '{}' is unknown; the file was written by a later version of dvi", name));
  out.set_lens(make_lens(*model, distortion, entry.value("xi", 0.0)));
  return out;
}

}  // namespace dvi
