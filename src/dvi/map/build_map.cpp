#include "dvi/map/build_map.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "dvi/core/threads.h"
#include "dvi/map/deskew.h"

namespace dvi {
namespace {

constexpr float kTile = 16;  // metres, edge of the columns that a view is culled by

using Key = Eigen::Vector3i;

struct KeyHash {
  std::size_t operator()(const Key& k) const {
    const auto mix = [](std::int32_t v, std::uint64_t prime) { return static_cast<std::uint64_t>(v) * prime; };
    return mix(k.x(), 73856093) ^ mix(k.y(), 19349669) ^ mix(k.z(), 83492791);
  }
};

struct Cell {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double intensity = 0;
  std::uint32_t count = 0;
};

using Voxels = std::unordered_map<Key, Cell, KeyHash>;

/// The frame a sweep is judged by: the one nearest in time, if it is of this sweep at all.
struct Witness {
  std::size_t frame = 0;
  SE3 camera_from_world;
  SE3 lidar_from_world;
};

std::optional<Witness> witness_of(const Sweep& sweep, const MapInput& input) {
  const std::vector<Frame>& frames = input.drive->frames;
  const auto distance = [&](const Frame& f) { return std::abs(f.time_ns - sweep.time_ns); };
  const auto nearest =
      std::min_element(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) { return distance(a) < distance(b); });
  if (nearest == frames.end() || distance(*nearest) > sweep.end_ns - sweep.start_ns) return std::nullopt;
  const std::optional<SE3> pose = input.world_from_lidar.at(nearest->time_ns);
  if (!pose) return std::nullopt;
  const SE3 lidar_from_world = pose->inverse();
  return Witness{static_cast<std::size_t>(nearest - frames.begin()), input.drive->camera_from_lidar * lidar_from_world,
                 lidar_from_world};
}

struct KeptPoint {
  Eigen::Vector3d position;
  float intensity;
};

struct SweepResult {
  std::vector<KeptPoint> kept;
  MapCounts counts;
};

class Filter {
 public:
  Filter(const MapInput& input, const MapOptions& options) : input_(input), options_(options) {}

  SweepResult operator()(std::size_t index) const {
    const Sweep& sweep = input_.drive->sweeps[index];
    const std::shared_ptr<const Scan> scan = input_.drive->scans[index];
    SweepResult out;
    out.counts.returns = scan->size();
    const std::vector<Eigen::Vector3d> world = to_world(*scan, sweep, input_.world_from_lidar);
    if (world.empty()) {
      out.counts.sweeps_without_pose = 1;
      return out;
    }
    out.counts.sweeps = 1;
    const std::optional<Witness> witness = witness_of(sweep, input_);
    const std::shared_ptr<const cv::Mat1b> mask = witness ? input_.masks[witness->frame] : nullptr;
    for (std::size_t i = 0; i < world.size(); ++i) {
      const float range = scan->points[i].norm();
      if (range < options_.min_range_m || range > options_.max_range_m)
        ++out.counts.too_near;
      else if (witness && boxed(*witness, world[i]))
        ++out.counts.boxed;
      else
        judge(world[i], scan->intensity[i], witness, mask.get(), out);
    }
    return out;
  }

 private:
  bool boxed(const Witness& witness, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d in_lidar = witness.lidar_from_world * point;
    const std::vector<Label>& labels = input_.drive->frames[witness.frame].labels;
    return std::any_of(labels.begin(), labels.end(),
                       [&](const Label& l) { return l.box && l.box->contains(in_lidar, options_.box_margin_m); });
  }

  void judge(const Eigen::Vector3d& point, float intensity, const std::optional<Witness>& witness, const cv::Mat1b* mask,
             SweepResult& out) const {
    bool seen = false;
    if (witness) {
      const Camera& camera = input_.drive->camera;
      const Eigen::Vector3d in_camera = witness->camera_from_world * point;
      if (camera.in_front(in_camera)) {
        const Eigen::Vector2d pixel = camera.project(in_camera);
        seen = camera.contains(pixel);
        if (seen && (*mask)(cvRound(pixel.y()), cvRound(pixel.x())) != 0) {
          ++out.counts.masked;
          return;
        }
      }
    }
    if (!seen && options_.witnessed_only)
      ++out.counts.unwitnessed;
    else
      out.kept.push_back({point, intensity});
  }

  const MapInput& input_;
  const MapOptions& options_;
};

void add(MapCounts& sum, const MapCounts& more) {
  sum.returns += more.returns;
  sum.masked += more.masked;
  sum.boxed += more.boxed;
  sum.unwitnessed += more.unwitnessed;
  sum.too_near += more.too_near;
  sum.sweeps += more.sweeps;
  sum.sweeps_without_pose += more.sweeps_without_pose;
}

// Voxels in an order that does not depend on the hash, tile by tile.
StaticMap to_map(const Voxels& voxels, double voxel_m) {
  struct Placed {
    int tile_x, tile_y;
    Key key;
    const Cell* cell;
  };
  std::vector<Placed> order;
  order.reserve(voxels.size());
  for (const auto& [key, cell] : voxels) {
    const auto tile = [&](int k) { return static_cast<int>(std::floor(k * voxel_m / kTile)); };
    order.push_back({tile(key.x()), tile(key.y()), key, &cell});
  }
  std::sort(order.begin(), order.end(), [](const Placed& a, const Placed& b) {
    return std::tie(a.tile_x, a.tile_y, a.key.x(), a.key.y(), a.key.z()) <
           std::tie(b.tile_x, b.tile_y, b.key.x(), b.key.y(), b.key.z());
  });
  StaticMap map;
  map.points.reserve(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool new_tile = i == 0 || order[i].tile_x != order[i - 1].tile_x || order[i].tile_y != order[i - 1].tile_y;
    if (new_tile) map.tiles.push_back({{}, i, i});
    const Cell& cell = *order[i].cell;
    map.points.push_back({(cell.sum / cell.count).cast<float>(), static_cast<float>(cell.intensity / cell.count), cell.count});
    map.tiles.back().bounds.extend(map.points.back().position);
    map.tiles.back().last = i + 1;
  }
  return map;
}

}  // namespace

std::size_t scan_count(const std::vector<MapInput>& inputs) {
  std::size_t count = 0;
  for (const MapInput& input : inputs) count += input.drive->sweeps.size();
  return count;
}

StaticMap build_map(const std::vector<MapInput>& inputs, const MapOptions& options, const Tick& tick) {
  Voxels voxels;
  MapCounts counts;
  for (const MapInput& input : inputs) {
    const Filter filter(input, options);
    for_blocks(input.drive->sweeps.size(), [&](std::size_t first, std::size_t last) {
      std::vector<SweepResult> results(last - first);
      parallel_for(results.size(), [&](std::size_t i) { results[i] = filter(first + i); });
      for (const SweepResult& result : results) {  // in the order of the sweeps, so that sums do not depend on scheduling
        add(counts, result.counts);
        for (const KeptPoint& point : result.kept) {
          Cell& cell = voxels[(point.position / options.voxel_m).array().floor().cast<int>().matrix()];
          cell.sum += point.position;
          cell.intensity += point.intensity;
          ++cell.count;
        }
        tick();
      }
    });
  }
  StaticMap map = to_map(voxels, options.voxel_m);
  map.counts = counts;
  return map;
}

}  // namespace dvi
