#pragma once

#include <nlohmann/json_fwd.hpp>

#include "dvi/inputs/poses_report.h"

namespace dvi::inputs {

// The reports of this module as JSON. Only .cpp files that write or read a document include this.
void to_json(nlohmann::json& json, const PosesReport& report);
void from_json(const nlohmann::json& json, PosesReport& report);

}  // namespace dvi::inputs
