#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"
#include "dvi/report/top_view.h"

namespace dvi::result {

/// Returns the paths of the 3D boxes of the target's labels, in frames that have a pose.
std::vector<report::ObjectPath> collect_object_paths(const FrameLabels& labels, const Views& views,
                                                     const Trajectory& world_from_lidar);

/// The contents of the map's files.
struct MapContents {
  const map::StaticMap& map;
  const Views& views;
  const Drive& target;
  std::vector<report::ObjectPath> objects;  ///< paths of the target's objects
  std::vector<std::string> cameras{};       ///< the cleaned cameras; if there are several, each has poses of its own
};

/// Writes to a folder: poses.txt (world_from_camera in KITTI's format, one line per frame of the target), times.txt (seconds),
/// CAMERA/poses.txt and CAMERA/times.txt of each camera if there are several,
/// map.ply (with the colors of points that the target's frames observe), moving.ply (removed points, colored by cause), and
/// map.png and above.json (report/above.h).
void write_map_files(const fs::path& folder, const MapContents& contents);

/// The lines of a trajectory file: 12 numbers of [R | t] (KITTI), or seconds and tx ty tz qx qy qz qw (TUM).
enum class TrajectoryFormat { kitti, tum };

/// Returns the format of this name, or nothing for "none". Throws UsageError for other names.
std::optional<TrajectoryFormat> parse_trajectory_format(const std::string& name);

/// Writes world_from_lidar at the middle of each scan that has a pose, one line per scan.
void write_trajectory(const fs::path& file, const Drive& drive, const Trajectory& world_from_lidar, TrajectoryFormat format);

}  // namespace dvi::result
