#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/pipeline/cpu_clock.h"
#include "dvi/pipeline/fill.h"
#include "dvi/pipeline/open.h"

namespace dvi::pipeline {

/// What report.json says of one frame.
nlohmann::json frame_report(const Frame& frame, const FilledView& view, const align::ViewAlignment& alignment);

/// What map.json says: points, and returns dropped by cause.
nlohmann::json map_report(const map::StaticMap& map);

/// One entry a drive: what it is, how its poses were aligned (none where `alignment` is empty), and what was missing in it.
nlohmann::json drives_report(const std::vector<OpenDrive>& drives, const std::vector<align::DriveAlignment>& alignment);

/// What sources.json says: the image behind each number in a frame's receipts.
nlohmann::json sources_report(const Views& views, const std::vector<OpenDrive>& drives);

/// Wall and CPU seconds of each stage, and CPU seconds for each of `count` units ("frame").
nlohmann::json stages_report(const Progress& progress, const std::string& unit, std::size_t count);

/// What a run cost: its stages, what filling was made of, peak memory.
nlohmann::json cost_report(const Progress& progress, const CpuClock& clock, std::size_t frames);

/// Shares of each kind over all frames, from their reports.
nlohmann::json hole_report(const std::vector<nlohmann::json>& frames);

}  // namespace dvi::pipeline
