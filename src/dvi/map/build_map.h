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
  std::optional<double> min_range_m;       ///< of the scan; none: Drive::least_range_m()
  std::optional<double> max_range_m = {};  ///< none: Drive::most_range_m()
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
              "Keep only points that the camera saw unmasked when they were scanned; others may belong to traffic.");
    table.add("carve", carve, "Free-space carving: remove points that rays of other scans passed through.");
    table.add("box_margin_m", box_margin_m, {0, 5},
              "Margin added to labeled 3D boxes before their points are dropped; objects move while they are scanned.");
  }
};

/// What another camera of a drive saw.
struct MapCamera {
  const Drive* drive = nullptr;
  Lazy<cv::Mat1b> masks;  ///< as drive->frames
};

/// One drive as the map sees it.
struct MapInput {
  const Drive* drive = nullptr;
  Trajectory world_from_lidar;
  Lazy<cv::Mat1b> masks;                  ///< as drive->frames
  SharedLabels objects{};                 ///< labels of what is removed, as drive->frames; null: none
  std::vector<MapCamera> more_cameras{};  ///< whose sight of a point counts as much
  SE3 world_from_map{};                   ///< of drive->map, where there is one
};

/// The static map of several drives in one world: scans are compensated for the motion within the scan; points that project
/// into the mask of the frame nearest in time, unless another camera saw them unmasked, or lie in its labeled boxes are
/// dropped (section 3.1 of the paper), the rest is thinned to one mean point a voxel; then voxels that rays of other scans went
/// through are dropped. A map that a drive brings is taken as it is, as far from its path as scans are. Streams over scans:
/// memory grows with the area seen, up to the bound of Scratch::of_process(). Parts: map, carve, normals.
StaticMap build_map(const std::vector<MapInput>& inputs, const MapOptions& options, const BeginPart& begin = no_parts);

}  // namespace dvi::map
