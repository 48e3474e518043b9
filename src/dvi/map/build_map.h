#pragma once

#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/drive/drive.h"
#include "dvi/map/static_map.h"

namespace dvi::map {

struct MapOptions {
  double voxel_m = 0.05;
  double min_range_m = 2.0;
  double max_range_m = 120;
  double box_margin_m = 0.2;
  bool witnessed_only = true;
  bool carve = true;
  double pose_error_m = 0.05;
  int memory_mb = 2000;

  void describe(OptionTable& table) {
    table.section("map");
    table.add("voxel_m", voxel_m, {0.005, 1}, "Edge of the voxels the map is thinned by.");
    table.add("min_range_m", min_range_m, {0, 20}, "Nearer returns are assumed to be the recording car itself.");
    table.add("max_range_m", max_range_m, {1, 500}, "Farther returns are left out.");
    table.add("box_margin_m", box_margin_m, {0, 5}, "Labelled 3D boxes are grown by this before their points are dropped.");
    table.add("witnessed_only", witnessed_only,
              "Keep only points that the camera saw, unmasked, when they were scanned: what it did not see may have moved.");
    table.add("carve", carve, "Free-space carving: remove points that rays of other scans passed through.");
    table.add("pose_error_m", pose_error_m, {0, 1},
              "Assumed pose error between scans; carving keeps this distance from surfaces.");
    table.add("memory_mb", memory_mb, {0, 1e6},
              "Memory for the map; beyond it, tiles are paged to unlinked temporary files in TMPDIR.");
  }
};

/// One drive as the map sees it.
struct MapInput {
  const Drive* drive = nullptr;
  Trajectory world_from_lidar;
  Lazy<cv::Mat1b> masks;  ///< as drive->frames
  FrameLabels objects{};  ///< labels of what is removed, as drive->frames; empty: none
};

/// The static map of several drives in one world: scans are compensated for the motion within the scan; points that project
/// into the mask of the frame nearest in time or lie in its labelled boxes are dropped (section 3.1 of the paper), the rest is
/// thinned to one mean point a voxel; then voxels that rays of other scans went through are dropped. Streams over scans:
/// memory grows with the area seen, up to a bound. Parts: map, carve, normals.
StaticMap build_map(const std::vector<MapInput>& inputs, const MapOptions& options, const BeginPart& begin = no_parts);

}  // namespace dvi::map
