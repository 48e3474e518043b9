#include "dvi/map/given_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

namespace dvi::map {
namespace {

/// Finds the nearest position of a path, from a grid on the ground.
class PathIndex {
 public:
  PathIndex(const std::vector<Eigen::Vector3f>& path, double range) {
    const int radius = static_cast<int>(std::ceil(range / kCellM));
    std::optional<Eigen::Vector3f> last;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (last && (*last - path[i]).norm() < kMinStepM) continue;
      last = path[i];
      const Eigen::Vector2i middle = cell(path[i]);
      for (int x = middle.x() - radius; x <= middle.x() + radius; ++x)
        for (int y = middle.y() - radius; y <= middle.y() + radius; ++y) {
          const Eigen::Vector2f center(kCellM * (static_cast<float>(x) + 0.5F), kCellM * (static_cast<float>(y) + 0.5F));
          const float distance = (center - path[i].head<2>()).norm();
          if (distance > range) continue;
          const auto [at, is_new] = cells_.try_emplace(key({x, y}), Nearest{i, distance});
          if (!is_new && distance < at->second.distance) at->second = {i, distance};
        }
    }
  }
  std::optional<std::size_t> find_nearest(const Eigen::Vector3f& point) const {
    constexpr float kMaxCoordinateM = 1e6F;  // larger ones would overflow the cell indices
    if (!(point.cwiseAbs().maxCoeff() < kMaxCoordinateM)) return std::nullopt;
    const auto found = cells_.find(key(cell(point)));
    return found == cells_.end() ? std::nullopt : std::optional(found->second.index);
  }

 private:
  static constexpr float kCellM = 4, kMinStepM = 1;
  struct Nearest {
    std::size_t index = 0;
    float distance = 0;
  };
  static Eigen::Vector2i cell(const Eigen::Vector3f& point) { return (point.head<2>() / kCellM).array().floor().cast<int>(); }
  static std::int64_t key(const Eigen::Vector2i& cell) { return (std::int64_t{cell.x()} << 32) + cell.y(); }

  std::unordered_map<std::int64_t, Nearest> cells_;
};

double get_max_range_m(const Drive& drive, const MapOptions& options) {
  return options.max_range_m.value_or(drive.max_range_m());
}

/// Makes a scan without returns for each frame of the drive that has a pose.
std::vector<MapScan> make_empty_scans(const Drive& drive, const Trajectory& world_from_lidar, std::size_t number) {
  std::vector<MapScan> out;
  for (const Frame& frame : drive.frames)
    if (const auto here = world_from_lidar.at(frame.time_ns)) out.push_back({number, frame.time_ns, here->t.cast<float>()});
  return out;
}

std::vector<Eigen::Vector3f> list_sensors(const std::vector<MapScan>& scans) {
  std::vector<Eigen::Vector3f> out;
  for (const MapScan& scan : scans) out.push_back(scan.sensor);
  return out;
}

}  // namespace

std::size_t add_given_points(const MapInput& input, const MapOptions& options, std::size_t drive, ObservedVoxels& sums) {
  auto& [voxels, scans] = sums;
  const std::vector<MapScan> path = make_empty_scans(*input.drive, input.world_from_lidar, drive);
  const PathIndex near(list_sensors(path), get_max_range_m(*input.drive, options));
  const std::size_t first = scans.size();
  scans.insert(scans.end(), path.begin(), path.end());
  const std::shared_ptr<const GivenMap> map = input.drive->map[0];
  const Eigen::Vector3d origin = input.world_from_map * map->origin;
  std::size_t added = 0;
  for (std::size_t i = 0; i < map->points.size(); ++i) {
    const Eigen::Vector3d position = origin + input.world_from_map.R * map->points[i].cast<double>();
    const std::optional<std::size_t> index = near.find_nearest(position.cast<float>());
    if (!index) continue;
    MapVoxel& voxel = voxels.at(position);
    if (voxel.count == 0) voxel.first = voxel.last = static_cast<std::uint32_t>(first + *index);
    voxel.offset_sum += (position - voxels.center(voxels.index(position))).cast<float>();
    voxel.intensity_sum += map->intensity[i];
    ++voxel.count, ++added;
    if (added % (std::size_t{1} << 20) == 0) voxels.page_out();
  }
  return added;
}

GivenCoverage measure_given_coverage(const Drive& drive, const MapOptions& options) {
  const std::shared_ptr<const GivenMap> map = drive.map[0];
  GivenCoverage out{.points = map->points.size(), .nearest_m = std::numeric_limits<double>::infinity()};
  const Trajectory from_origin = drive.poses.in({Eigen::Matrix3d::Identity(), -map->origin});
  const std::vector<MapScan> path = make_empty_scans(drive, from_origin, 0);
  if (path.empty()) return out;
  const PathIndex near(list_sensors(path), get_max_range_m(drive, options));
  for (const Eigen::Vector3f& point : map->points) {
    if (near.find_nearest(point)) ++out.near;
    out.nearest_m = std::min(out.nearest_m, static_cast<double>((point - path.front().sensor).norm()));
  }
  return out;
}

}  // namespace dvi::map
