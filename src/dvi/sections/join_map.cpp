#include "dvi/sections/join_map.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/sections/join_poses.h"

namespace dvi::sections {
namespace {

using map::MapPoint, map::MapScan, map::StaticMap;

/// The distance in meters between the positions of a path that removed points are compared with.
constexpr float kPathStepM = 10;

/// A section's part of the joint map.
struct Part {
  std::size_t index = 0;  ///< of the section
  const std::vector<Border>& borders;
  std::vector<std::optional<Eigen::Isometry3f>> joint_from_section;  ///< per scan of the section's map

  bool owns(std::int64_t time_ns) const { return section_at(borders, time_ns) == index; }
};

Eigen::Isometry3f to_float(const SE3& motion) {
  Eigen::Isometry3f out = Eigen::Isometry3f::Identity();
  out.linear() = motion.R.cast<float>();
  out.translation() = motion.t.cast<float>();
  return out;
}

/// Returns the motions of the scans of a section's map.
std::vector<std::optional<Eigen::Isometry3f>> find_motions(const PlannedSection& section, const inputs::Poses& poses,
                                                           const std::vector<MapScan>& scans) {
  std::vector<std::optional<Eigen::Isometry3f>> motions;
  for (const MapScan& scan : scans) {
    const std::optional<SE3> motion = joint_from_section(poses[scan.drive].world_from_lidar, section, scan.drive, scan.time_ns);
    motions.push_back(motion ? std::optional(to_float(*motion)) : std::nullopt);
  }
  return motions;
}

/// Returns the scan that represents a point if the point belongs to the part: of a point that the target observed, the scan in
/// the middle. Points of source drives only are taken from the first section.
std::optional<std::size_t> find_own_scan(const MapPoint& point, const std::vector<MapScan>& scans, const Part& part) {
  const MapScan &first = scans[point.first], &last = scans[point.last];
  if (first.drive != 0) return part.index == 0 ? std::optional<std::size_t>(point.first) : std::nullopt;
  const std::int64_t middle = last.drive == 0 ? first.time_ns + (last.time_ns - first.time_ns) / 2 : first.time_ns;
  if (!part.owns(middle)) return std::nullopt;
  const auto after = std::partition_point(scans.begin() + point.first, scans.begin() + point.last,
                                          [&](const MapScan& scan) { return scan.drive == 0 && scan.time_ns < middle; });
  return static_cast<std::size_t>(after - scans.begin());
}

void add_points(const StaticMap& from, const Part& part, StaticMap& joint) {
  const auto first_scan = static_cast<std::uint32_t>(joint.scans.size());
  for (const StaticMap::Tile& tile : from.tiles) {
    StaticMap::Tile out{{}, joint.points.size(), 0};
    for (std::size_t i = tile.first; i < tile.last; ++i) {
      MapPoint point = from.points[i];
      const std::optional<std::size_t> scan = find_own_scan(point, from.scans, part);
      if (!scan || !part.joint_from_section[*scan]) continue;
      const Eigen::Isometry3f& motion = *part.joint_from_section[*scan];
      point.position = motion * point.position;
      point.normal = motion.linear() * point.normal;
      point.first += first_scan;
      point.last += first_scan;
      joint.points.push_back(point);
      out.bounds.extend(point.position);
    }
    out.last = joint.points.size();
    if (out.first < out.last) joint.tiles.push_back(out);
  }
}

/// Returns the target's scans at intervals of kPathStepM.
std::vector<std::size_t> sample_path(const std::vector<MapScan>& scans) {
  std::vector<std::size_t> path;
  for (std::size_t i = 0; i < scans.size(); ++i)
    if (scans[i].drive == 0 && (path.empty() || (scans[i].sensor - scans[path.back()].sensor).norm() >= kPathStepM))
      path.push_back(i);
  return path;
}

void add_removed(const StaticMap& from, const Part& part, StaticMap& joint) {
  const std::vector<std::size_t> path = sample_path(from.scans);
  for (map::RemovedPoint point : from.removed) {
    std::optional<std::size_t> nearest;
    float distance = std::numeric_limits<float>::infinity();
    for (const std::size_t scan : path)
      if (const float to_scan = (from.scans[scan].sensor - point.position).squaredNorm(); to_scan < distance)
        nearest = scan, distance = to_scan;
    if (!nearest || !part.owns(from.scans[*nearest].time_ns) || !part.joint_from_section[*nearest]) continue;
    point.position = *part.joint_from_section[*nearest] * point.position;
    joint.removed.push_back(point);
  }
}

void add_scans(const StaticMap& from, const Part& part, StaticMap& joint) {
  for (std::size_t i = 0; i < from.scans.size(); ++i) {
    MapScan scan = from.scans[i];
    if (part.joint_from_section[i]) scan.sensor = *part.joint_from_section[i] * scan.sensor;
    joint.scans.push_back(scan);
  }
}

}  // namespace

StaticMap join_maps(const std::vector<PlannedSection>& sections, const inputs::Poses& poses, const std::vector<Border>& borders,
                    const std::function<StaticMap(std::size_t)>& load_map) {
  StaticMap joint(Scratch::of_process());
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const StaticMap map = load_map(k);
    const Part part{k, borders, find_motions(sections[k], poses, map.scans)};
    add_points(map, part, joint);
    add_removed(map, part, joint);
    add_scans(map, part, joint);
    joint.counts += map.counts;
    joint.page_out();
  }
  return joint;
}

}  // namespace dvi::sections
