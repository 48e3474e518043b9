#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/result/run_report.h"

namespace dvi::result {

// The reports as JSON, for those who write it: only .cpp files that write a document include this.
void to_json(nlohmann::json& json, const MapReport& report);
void from_json(const nlohmann::json& json, MapReport& report);

void to_json(nlohmann::json& json, const CostReport& report);
void from_json(const nlohmann::json& json, CostReport& report);

nlohmann::json json_of(const FoundPlace& found);
nlohmann::json json_of(const FrameReport& report);
nlohmann::json json_of(const HoleReport& hole);
FrameReport frame_of(const nlohmann::json& json);

/// Wall and CPU seconds of each stage, and CPU seconds for each of `count` units ("frame").
nlohmann::json stages_json(const std::vector<StageTime>& stages, const std::string& unit, std::size_t count);

}  // namespace dvi::result
