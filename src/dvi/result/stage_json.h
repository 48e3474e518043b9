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

// These functions convert the summaries of the stages to the JSON of report.json, map.json, and `dvi check --json`.

/// Returns the source of a drive's poses, the sharpness of their map, and the figures of the odometry.
nlohmann::json poses_json(const Drive& drive, const inputs::PoseChoice& choice);

/// Returns the size of a map, and the number of dropped returns per reason.
nlohmann::json map_json(const map::StaticMap& map);

/// Returns one entry per drive, with its other cameras.
nlohmann::json drives_json(const inputs::Recordings& drives, const inputs::Poses& poses, const align::Cameras& cameras);

/// Returns the figures of one frame: its hole by origin, energies, alignment, and gain. `camera` is empty if the result has
/// one.
nlohmann::json frame_json(const std::string& camera, const Frame& frame, const FilledView& view,
                          const align::ViewAlignment& alignment);

/// Returns the place on Earth of the target's first LiDAR pose.
nlohmann::json place_json(const FoundPlace& found);

/// Returns wall and CPU seconds of each stage, and CPU seconds for each of `count` units ("frame").
nlohmann::json stages_json(const std::vector<StageTime>& stages, const std::string& unit, std::size_t count);

}  // namespace dvi::result
