#include "dvi/map/build_map.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "dvi/core/threads.h"
#include "dvi/map/carve.h"
#include "dvi/map/given_points.h"
#include "dvi/map/map_voxel.h"
#include "dvi/map/normals.h"
#include "dvi/map/scan_filter.h"

namespace dvi::map {
namespace {

struct RemovedVoxel {
  Cause cause = Cause::masked;
};

/// The sums over all scans before carving.
struct ScanSums {
  ScanSums(double edge, const std::shared_ptr<Scratch>& scratch)
      : observed{MapVoxels(edge, scratch), {}}, removed(edge, scratch) {}

  ObservedVoxels observed;
  VoxelGrid<RemovedVoxel> removed;
  MapCounts counts;

  void add(const FilteredScan& scan, std::size_t drive, std::int64_t time_ns);
};

void ScanSums::add(const FilteredScan& scan, std::size_t drive, std::int64_t time_ns) {
  counts += scan.counts;
  for (const RemovedPoint& point : scan.removed) {
    RemovedVoxel& voxel = removed.at(point.position.cast<double>());
    voxel.cause = std::max(voxel.cause, point.cause);
  }
  if (!scan.sensor) return;
  auto& [voxels, scans] = observed;
  const auto number = static_cast<std::uint32_t>(scans.size());
  scans.push_back({drive, time_ns, *scan.sensor});
  for (const FilteredScan::Kept& point : scan.kept) {
    MapVoxel& voxel = voxels.at(point.position);
    if (voxel.count == 0) voxel.first = number;
    voxel.last = number;
    voxel.offset_sum += (point.position - voxels.center(voxels.index(point.position))).cast<float>();
    voxel.intensity_sum += point.intensity;
    ++voxel.count;
  }
}

constexpr std::size_t kPageOutScans = 8;  // scans after which the map is paged out

void gather(const std::vector<MapInput>& inputs, const MapOptions& options, ScanSums& all, const Tick& tick) {
  for (std::size_t drive = 0; drive < inputs.size(); ++drive) {
    const std::vector<ScanHeader>& scan_headers = inputs[drive].drive->scan_headers;
    make_and_use(
        scan_headers.size(), [&](std::size_t i) { return filter_scan(inputs[drive], options, i); },
        [&](std::size_t i, const FilteredScan& scan) {  // in order, so that sums do not depend on the scheduling
          all.add(scan, drive, scan_headers[i].time_ns);
          if (i % kPageOutScans == 0) all.observed.voxels.page_out();
          tick();
        });
  }
}

/// Sorts the voxels of a tile by their coordinates.
template <class Tile>
std::vector<std::size_t> sort_voxels(const Tile& tile) {
  std::vector<std::size_t> order(tile.indices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) {
    const Eigen::Vector3i& p = tile.indices[i];
    return std::tie(p.x(), p.y(), p.z());
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return order;
}

/// Adds the voxels of a tile to the map.
void add_tile(const MapVoxels& voxels, const MapVoxels::Tile& tile, bool carve, StaticMap& map) {
  StaticMap::Tile out{{}, map.points.size(), 0};
  for (const std::size_t i : sort_voxels(tile)) {
    const MapVoxel& voxel = tile.voxels[i];
    const Eigen::Vector3f position = compute_mean(voxels, tile.indices[i], voxel).cast<float>();
    if (carve && has_moved(voxel)) {
      map.counts.moved += voxel.count;
      map.removed.push_back({position, Cause::moved});
      continue;
    }
    map.points.push_back({position, voxel.intensity_sum / static_cast<float>(voxel.count), voxel.count, voxel.first, voxel.last,
                          Eigen::Vector3f::Zero(), voxel.absent});
    out.bounds.extend(position);
  }
  out.last = map.points.size();
  if (out.first < out.last) map.tiles.push_back(out);
}

/// Moves the voxels into the map, tile by tile.
void move_to_map(ScanSums& sums, bool carve, StaticMap& map) {
  map.scans = sums.observed.scans;
  map.counts = sums.counts;
  std::size_t voxels = 0;
  for (const auto& [column, tile] : sums.observed.voxels.tiles()) voxels += tile.voxels.size();
  map.points.reserve(voxels);  // a growing vector would be in memory twice
  for (auto& [column, tile] : sums.observed.voxels.tiles()) {
    add_tile(sums.observed.voxels, tile, carve, map);
    tile = MapVoxels::Tile(map.scratch());
    map.page_out();
  }
  for (const auto& [column, tile] : sums.removed.tiles())
    for (const std::size_t i : sort_voxels(tile))
      map.removed.push_back({sums.removed.center(tile.indices[i]).cast<float>(), tile.voxels[i].cause});
}

}  // namespace

StaticMap build_map(const std::vector<MapInput>& inputs, const MapOptions& options, const BeginPart& begin) {
  std::size_t scans = 0;
  for (const MapInput& input : inputs) scans += input.drive->scan_headers.size();
  StaticMap map(Scratch::of_process());
  ScanSums sums(options.voxel_m, map.scratch());
  gather(inputs, options, sums, begin("map", scans));
  for (std::size_t drive = 0; drive < inputs.size(); ++drive)
    if (!inputs[drive].drive->map.empty())
      sums.counts.returns += add_given_points(inputs[drive], options, drive, sums.observed);
  if (options.carve) count_hits_and_passes(sums.observed.voxels, inputs, options.pose_error_m, begin("carve", scans));
  begin("normals", 0);
  move_to_map(sums, options.carve, map);
  add_normals(map);
  return map;
}

}  // namespace dvi::map
