#include "dvi/scan_match/scan_features.h"

#include <limits>

namespace dvi::scan_match {
namespace {

// The factors by which options are adapted to a sensor.
struct SensorParams {
  // In relation to the range of scans: near features may be edges of the recording vehicle, and far ones are too sparse for
  // planes.
  double min_range_factor = 1.25, max_range_factor = 0.75;
  // In relation to the lengths for streets: 3, 6 and 10 cm, and 1 cm of noise.
  double room_spacing = 0.15, room_cell = 0.1, room_voxel = 0.2, room_noise = 0.33;
  double large_voxel = 3, edge_voxel = 1.6;  // in relation to the small voxel
};
constexpr SensorParams kSensorParams;

}  // namespace

MatchOptions adapt_to_sensor(MatchOptions options, const Drive& drive) {
  options.max_range_m = options.max_range_m.value_or(drive.max_range_m());
  if (drive.sensor != Sensor::depth_camera) return options;
  options.spacing_m *= kSensorParams.room_spacing;
  options.cell_m *= kSensorParams.room_cell;
  options.voxel_m *= kSensorParams.room_voxel;
  options.noise_m *= kSensorParams.room_noise;
  options.kernel_m *= kSensorParams.room_noise;
  return options;
}

Rings find_scan_rings(const Drive& drive, const Scan& scan) {
  return drive.sensor == Sensor::depth_camera ? Rings{} : find_rings(scan);
}

double find_feature_range(const MatchOptions& options) {
  return kSensorParams.max_range_factor * options.max_range_m.value_or(std::numeric_limits<double>::infinity());
}

ScanFeatures extract_scan_features(const Drive& drive, const Scan& scan, const Rings& rings, const MatchOptions& options) {
  const double nearest = kSensorParams.min_range_factor * options.min_range_m.value_or(drive.min_range_m());
  const Features all = find_features(scan, rings, {nearest, find_feature_range(options), 0.75 * options.spacing_m});
  ScanFeatures out;
  out.dense = {thin_features(all.planes, options.spacing_m), all.edges};
  out.sparse = {thin_features(out.dense.planes, options.cell_m), thin_features(all.edges, options.voxel_m)};
  return out;
}

LocalMaps make_empty_scene(const MatchOptions& options) {
  return {LocalMap(options.voxel_m), LocalMap(kSensorParams.large_voxel * options.voxel_m),
          LocalMap(kSensorParams.edge_voxel * options.voxel_m)};
}

RegisterOptions to_register_options(const MatchOptions& options) {
  RegisterOptions out;
  out.noise_m = options.noise_m;
  out.kernel_m = options.kernel_m;
  return out;
}

}  // namespace dvi::scan_match
