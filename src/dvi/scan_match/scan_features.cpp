#include "dvi/scan_match/scan_features.h"

#include <limits>

namespace dvi::scan_match {
namespace {

// Of the scan's range: features next to the recording car may be its own edges, far ones are too sparse to tell planes.
constexpr double kNear = 1.25, kFar = 0.75;
// Of the lengths for streets: 3, 6 and 10 cm; 1 cm of noise.
constexpr double kRoomSpacing = 0.15, kRoomCell = 0.1, kRoomVoxel = 0.2, kRoomNoise = 0.33;
constexpr double kLargeVoxel = 3, kEdgeVoxel = 1.6;  // of the small voxel

}  // namespace

MatchOptions for_sensor(MatchOptions options, const Drive& drive) {
  options.max_range_m = options.max_range_m.value_or(drive.most_range_m());
  if (drive.sensor != Sensor::depth_camera) return options;
  options.spacing_m *= kRoomSpacing;
  options.cell_m *= kRoomCell;
  options.voxel_m *= kRoomVoxel;
  options.noise_m *= kRoomNoise;
  options.kernel_m *= kRoomNoise;
  return options;
}

Rings rings_of(const Drive& drive, const Scan& scan) {
  return drive.sensor == Sensor::depth_camera ? Rings{} : find_rings(scan);
}

double feature_range(const MatchOptions& options) {
  return kFar * options.max_range_m.value_or(std::numeric_limits<double>::infinity());
}

ScanFeatures scan_features(const Drive& drive, const Scan& scan, const Rings& rings, const MatchOptions& options) {
  const double nearest = kNear * options.min_range_m.value_or(drive.least_range_m());
  const Features all = find_features(scan, rings, {nearest, feature_range(options), 0.75 * options.spacing_m});
  ScanFeatures out;
  out.dense = {thinned(all.planes, options.spacing_m), all.edges};
  out.sparse = {thinned(out.dense.planes, options.cell_m), thinned(all.edges, options.voxel_m)};
  return out;
}

LocalMaps empty_scene(const MatchOptions& options) {
  return {LocalMap(options.voxel_m), LocalMap(kLargeVoxel * options.voxel_m), LocalMap(kEdgeVoxel * options.voxel_m)};
}

RegisterOptions register_options(const MatchOptions& options) {
  RegisterOptions out;
  out.noise_m = options.noise_m;
  out.kernel_m = options.kernel_m;
  return out;
}

}  // namespace dvi::scan_match
