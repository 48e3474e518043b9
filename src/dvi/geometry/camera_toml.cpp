#include "dvi/geometry/camera_toml.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dvi {

std::string format_intrinsics(const Camera& camera) {
  const Camera& c = camera;
  std::string text = fmt::format("K = [{}, 0, {}, 0, {}, {}, 0, 0, 1]\n", c.fx, c.cx, c.fy, c.cy);
  if (c.model != CameraModel::pinhole) text += fmt::format("model = \"{}\"\n", to_string(c.model));
  if (c.model == CameraModel::unified) text += fmt::format("xi = {}\n", c.xi);
  if (c.is_distorted() && !c.coefficients().empty())
    text += fmt::format("distortion = [{}]\n", fmt::join(c.coefficients(), ", "));
  return text;
}

}  // namespace dvi
