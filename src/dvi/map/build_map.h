#pragma once

#include <optional>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/drive.h"
#include "dvi/map/static_map.h"

namespace dvi::map {

struct MapOptions {
  double voxel_m = 0.05;
  std::optional<double> min_range_m;       ///< of a return; default: Drive::min_range_m()
  std::optional<double> max_range_m = {};  ///< default: Drive::max_range_m()
  double box_margin_m = 0.2;
  bool require_camera_visibility = true;
  bool carve = true;
  double pose_error_m = 0.05;

  void describe(OptionTable& table) {
    table.section("map");
    table.add("voxel_m", voxel_m, {0.005, 1}, "Edge of the voxels that hold one map point each.");
    table.add("pose_error_m", pose_error_m, {0, 1},
              "Expected position error between scans; free-space carving keeps this distance from rays.");
    table.developer();
    table.add("require_camera_visibility", require_camera_visibility,
              "Keep only points that a camera observed unmasked when they were scanned; others may belong to traffic.");
    table.add("carve", carve, "Free-space carving: remove points that rays of other scans passed through.");
    table.add("box_margin_m", box_margin_m, {0, 5},
              "Margin added to labeled 3D boxes before their points are dropped; objects move while they are scanned.");
  }
};

/// Another camera of a drive.
struct MapCamera {
  const Drive* drive = nullptr;
  Lazy<cv::Mat1b> masks;  ///< one per frame of the drive
};

/// One drive as input of the map.
struct MapInput {
  const Drive* drive = nullptr;
  Trajectory world_from_lidar;
  Lazy<cv::Mat1b> masks;                  ///< one per frame of the drive
  SharedLabels objects{};                 ///< labels of removed objects, per frame; null: none
  std::vector<MapCamera> more_cameras{};  ///< their observations count as much
  SE3 world_from_map{};                   ///< of drive->map, if the drive has one
};

/// Builds the static map of several drives in one world (section 3.1 of the paper). Scans are compensated for the motion within
/// the scan. Points are dropped if they are in a labeled box of the frame nearest in time, or if they project into its mask and
/// no other camera observed them unmasked. The rest is thinned to one mean point per voxel, and voxels that rays of other scans
/// passed through are removed. The points of a map that a drive brings are added within the range of its scans. Processes scans
/// one block at a time: memory grows with the observed area, up to the bound of Scratch::of_process(). Reports three parts of
/// progress, "map", "carve", and "normals".
StaticMap build_map(const std::vector<MapInput>& inputs, const MapOptions& options, const BeginPart& begin = no_parts);

}  // namespace dvi::map
