#pragma once

#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"
#include "dvi/report/top_view.h"

namespace dvi::result {

/// Where the 3D boxes of the target's labels were, in frames that have a pose.
std::vector<report::ObjectPath> tracks_of(const FrameLabels& labels, const Views& views, const Trajectory& world_from_lidar);

/// poses.txt (KITTI: world_from_camera, one line a frame of the target), times.txt (seconds), map.ply (colored by the
/// target's frames where they see it), moving.ply (what was taken out, colored by cause), map.png and above.json
/// (report/top_view.h) into a folder.
void write_map_files(const fs::path& folder, const map::StaticMap& map, const Views& views, const Drive& target,
                     const std::vector<report::ObjectPath>& tracks);

/// world_from_lidar at the middle of each scan that has a pose: 12 numbers a line (KITTI), or seconds and tx ty tz qx qy qz qw
/// (TUM).
void write_trajectory(const fs::path& file, const Drive& drive, const Trajectory& world_from_lidar, bool tum);

}  // namespace dvi::result
