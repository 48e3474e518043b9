#pragma once

#include <nlohmann/json_fwd.hpp>

#include "dvi/geometry/camera.h"

namespace dvi {

/// Returns the size, K, and distortion of a camera as in dvi.toml, and the model if it is not a pinhole camera.
nlohmann::json to_json(const Camera& camera);

/// The inverse. Throws nlohmann::json::exception if an entry is missing or has another type, and InputError
/// if the model is unknown.
Camera camera_from_json(const nlohmann::json& entry);

}  // namespace dvi
