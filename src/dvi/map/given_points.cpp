#include "dvi/map/given_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

namespace dvi::map {
namespace {

// Which of the places along the path is nearest, by cells of the ground about it.
class NearPath {
 public:
  NearPath(const std::vector<Eigen::Vector3f>& path, double range) {
    const int reach = static_cast<int>(std::ceil(range / kCell));
    std::optional<Eigen::Vector3f> last;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (last && (*last - path[i]).norm() < kStep) continue;
      last = path[i];
      const Eigen::Vector2i middle = cell(path[i]);
      for (int x = middle.x() - reach; x <= middle.x() + reach; ++x)
        for (int y = middle.y() - reach; y <= middle.y() + reach; ++y) {
          const Eigen::Vector2f center(kCell * (static_cast<float>(x) + 0.5F), kCell * (static_cast<float>(y) + 0.5F));
          const float distance = (center - path[i].head<2>()).norm();
          if (distance > range) continue;
          const auto [at, is_new] = cells_.try_emplace(key({x, y}), Nearest{i, distance});
          if (!is_new && distance < at->second.distance) at->second = {i, distance};
        }
    }
  }
  std::optional<std::size_t> nearest(const Eigen::Vector3f& point) const {
    constexpr float kFarthest = 1e6F;  // meters, so that cells can be counted in integers
    if (!(point.cwiseAbs().maxCoeff() < kFarthest)) return std::nullopt;
    const auto found = cells_.find(key(cell(point)));
    return found == cells_.end() ? std::nullopt : std::optional(found->second.place);
  }

 private:
  static constexpr float kCell = 4, kStep = 1;  // meters
  struct Nearest {
    std::size_t place = 0;
    float distance = 0;
  };
  static Eigen::Vector2i cell(const Eigen::Vector3f& point) { return (point.head<2>() / kCell).array().floor().cast<int>(); }
  static std::int64_t key(const Eigen::Vector2i& cell) { return (std::int64_t{cell.x()} << 32) + cell.y(); }

  std::unordered_map<std::int64_t, Nearest> cells_;
};

double range_of(const Drive& drive, const MapOptions& options) { return options.max_range_m.value_or(drive.max_range_m()); }

// Where the sensor was at the drive's frames.
std::vector<MapScan> places(const Drive& drive, const Trajectory& world_from_lidar, std::size_t number) {
  std::vector<MapScan> out;
  for (const Frame& frame : drive.frames)
    if (const auto here = world_from_lidar.at(frame.time_ns)) out.push_back({number, frame.time_ns, here->t.cast<float>()});
  return out;
}

std::vector<Eigen::Vector3f> path_of(const std::vector<MapScan>& scans) {
  std::vector<Eigen::Vector3f> out;
  for (const MapScan& scan : scans) out.push_back(scan.sensor);
  return out;
}

}  // namespace

std::size_t add_given(const MapInput& input, const MapOptions& options, std::size_t drive, std::vector<MapScan>& scans,
                      MapVoxels& voxels) {
  const std::vector<MapScan> path = places(*input.drive, input.world_from_lidar, drive);
  const NearPath near(path_of(path), range_of(*input.drive, options));
  const std::size_t first = scans.size();
  scans.insert(scans.end(), path.begin(), path.end());
  const std::shared_ptr<const GivenMap> map = input.drive->map[0];
  const Eigen::Vector3d origin = input.world_from_map * map->origin;
  std::size_t added = 0;
  for (std::size_t i = 0; i < map->points.size(); ++i) {
    const Eigen::Vector3d position = origin + input.world_from_map.R * map->points[i].cast<double>();
    const std::optional<std::size_t> place = near.nearest(position.cast<float>());
    if (!place) continue;
    MapVoxel& voxel = voxels.at(position);
    if (voxel.count == 0) voxel.first = voxel.last = static_cast<std::uint32_t>(first + *place);
    voxel.offset_sum += (position - voxels.center(voxels.place(position))).cast<float>();
    voxel.intensity_sum += map->intensity[i];
    ++voxel.count, ++added;
    if (added % (std::size_t{1} << 20) == 0) voxels.page_out();
  }
  return added;
}

GivenReach reach_of_given(const Drive& drive, const MapOptions& options) {
  const std::shared_ptr<const GivenMap> map = drive.map[0];
  GivenReach out{.points = map->points.size(), .nearest_m = std::numeric_limits<double>::infinity()};
  const Trajectory from_origin = drive.poses.in({Eigen::Matrix3d::Identity(), -map->origin});
  const std::vector<MapScan> path = places(drive, from_origin, 0);
  if (path.empty()) return out;
  const NearPath near(path_of(path), range_of(drive, options));
  for (const Eigen::Vector3f& point : map->points) {
    if (near.nearest(point)) ++out.near;
    out.nearest_m = std::min(out.nearest_m, static_cast<double>((point - path.front().sensor).norm()));
  }
  return out;
}

}  // namespace dvi::map
