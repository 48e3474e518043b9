#include "dvi/objects/completion/object_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "dvi/drive/outline.h"
#include "dvi/image/region.h"
#include "dvi/objects/completion/object_space.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct ColumnParams {
  double max_track_gap_s = 0.25;  ///< time to the observation of a track that shows its shape
  double margin_m = 0.125;        ///< around the columns, which closes gaps of one voxel
  int closing_px = 2;             ///< gaps that remain
  int margin_px = 2;              ///< blur of an object's edge in the image
};
constexpr ColumnParams kColumns;

}  // namespace

void ObjectColumns::add(const Eigen::Vector3d& point, double half_height_m) {
  const Eigen::Vector3i index = voxel_at(point);
  double& top_m = tops_m_.try_emplace(std::pair(index.x(), index.y()), -std::numeric_limits<double>::max()).first->second;
  top_m = std::max(top_m, point.z() + half_height_m);
}

void ObjectColumns::add(const ObjectColumns& other) {
  for (const auto& [column, other_m] : other.tops_m_) {
    double& top_m = tops_m_.try_emplace(column, other_m).first->second;
    top_m = std::max(top_m, other_m);
  }
}

std::optional<double> ObjectColumns::top_near(const Eigen::Vector2d& position, int columns) const {
  const Eigen::Vector3i middle = voxel_at({position.x(), position.y(), 0});
  std::optional<double> top_m;
  for (int x = middle.x() - columns; x <= middle.x() + columns; ++x) {
    const auto end = tops_m_.upper_bound({x, middle.y() + columns});
    for (auto column = tops_m_.lower_bound({x, middle.y() - columns}); column != end; ++column)
      top_m = std::max(top_m.value_or(column->second), column->second);
  }
  return top_m;
}

cv::Mat1b ObjectColumns::draw(const ground::ScanGround& ground, const Camera& camera, const SE3& camera_from_world) const {
  cv::Mat1b mask(camera.height, camera.width, uchar{0});
  const double low_m = -kColumns.margin_m, high_m = kObjectVoxelM + kColumns.margin_m;
  for (const auto& [column, top_m] : tops_m_) {
    const Eigen::Vector2d at = Eigen::Vector2d(column.first, column.second) * kObjectVoxelM;
    const double ground_m = ground.height(at).value_or(top_m - kObjectVoxelM);
    std::vector<Eigen::Vector3d> corners;
    for (const double dx : {low_m, high_m})
      for (const double dy : {low_m, high_m})
        for (const double z : {ground_m, top_m})
          corners.push_back(camera_from_world * Eigen::Vector3d(at.x() + dx, at.y() + dy, z));
    if (std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector3d& x) { return camera.in_front(x); }))
      draw_hull(corners, camera, mask);
  }
  return grown(grown(mask, kColumns.closing_px), kColumns.margin_px - kColumns.closing_px);
}

double ObjectColumns::nearest_m(const Camera& camera, const SE3& camera_from_world) const {
  double nearest_m = std::numeric_limits<double>::max();
  for (const auto& [column, top_m] : tops_m_) {
    const Eigen::Vector3d top(column.first * kObjectVoxelM, column.second * kObjectVoxelM, top_m);
    nearest_m = std::min(nearest_m, camera.depth(camera_from_world * top));
  }
  return nearest_m;
}

ObjectColumns fill_columns(const Track& track, std::int64_t time_ns) {
  ObjectColumns out;
  if (track.observations.empty()) return out;
  const std::size_t nearest = track.nearest(time_ns);
  const Cluster& cluster = track.observations[nearest];
  if (std::abs(seconds_between(cluster.mean_time_ns, time_ns)) > kColumns.max_track_gap_s) return out;
  const Eigen::Vector2d velocity = track.velocity(nearest);
  const double top_m = top_of(cluster);
  for (const ClusterReturn& r : cluster.returns) {
    Eigen::Vector3d point = r.point;
    point.head<2>() += velocity * seconds_between(r.time_ns, time_ns);
    if (track.reaches_above_scans && is_near_top(r, top_m)) point.z() = std::max(point.z(), r.ground + track.height_m);
    out.add(point, 0.5 * std::min(r.ray_spacing_m, kObjectVoxelM));
  }
  return out;
}

}  // namespace dvi::objects
