#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/geometry/earth_place.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/map/static_map.h"
#include "dvi/result/filled_view.h"

namespace dvi::result {

// The summaries of the stages as report.json, map.json, and `dvi check --json` have them.

/// Where a drive's poses come from, how sharp a map they make, and how the odometry went.
nlohmann::json poses_json(const Drive& drive, const inputs::PoseChoice& choice);

/// The size of a map, and how many returns are not in it for which reason.
nlohmann::json map_json(const map::StaticMap& map);

/// One entry per drive, with its other cameras.
nlohmann::json drives_json(const inputs::Recordings& drives, const inputs::Poses& poses, const align::Cameras& cameras);

/// One frame: its hole by origin, energies, alignment, and gain.
nlohmann::json frame_json(const Frame& frame, const FilledView& view, const align::ViewAlignment& alignment);

/// The place on Earth of the target's first LiDAR pose.
nlohmann::json place_json(const FoundPlace& found);

/// Wall and CPU seconds of each stage, and CPU seconds for each of `count` units ("frame").
nlohmann::json stages_json(const std::vector<StageTime>& stages, const std::string& unit, std::size_t count);

}  // namespace dvi::result
