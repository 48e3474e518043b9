#include "dvi/holdout/obstacles.h"

#include <algorithm>
#include <optional>

#include <Eigen/Geometry>

#include "dvi/core/threads.h"
#include "dvi/geometry/box.h"
#include "dvi/map/scan_filter.h"
#include "dvi/objects/motion.h"

namespace dvi::holdout {
namespace {

constexpr double kMaxRangeM = 30;  // the height of the ground is unknown at larger ranges

/// Returns the box at each position at a time.
std::vector<Box> make_boxes(const RoadBoxes& places, std::int64_t time_ns) {
  constexpr double kMinHeightM = 0.3, kClearanceM = 0.2;
  const Eigen::Vector3d& size = places.size;
  const double highest = size.z() + kClearanceM;
  const SE3 lifted{Eigen::Matrix3d::Identity(), {0, 0, 0.5 * (kMinHeightM + highest)}};
  const Eigen::Vector3d grown(size.x() + 2 * kClearanceM, size.y() + 2 * kClearanceM, highest - kMinHeightM);
  std::vector<Box> boxes;
  for (const double meters : places.along)
    boxes.push_back({places.road.road_pose(meters, places.left, time_ns) * lifted, grown});
  return boxes;
}

}  // namespace

std::vector<std::size_t> count_returns_inside(const Drive& drive, const Trajectory& world_from_lidar, const RoadBoxes& places) {
  const Lazy<cv::Mat1b> no_masks(drive.frames.size(), 1,
                                 [&](std::size_t) { return cv::Mat1b(drive.camera.height, drive.camera.width, uchar{0}); });
  const map::MapInput input{&drive, world_from_lidar, no_masks, shared(objects::remove_stationary(drive, world_from_lidar))};
  map::MapOptions options;
  options.require_camera_visibility = false;
  options.max_range_m = kMaxRangeM;
  options.box_margin_m = 0.5;  // the motion of traffic within half a scan
  std::vector<std::vector<std::size_t>> counts(drive.scan_headers.size());
  parallel_for(counts.size(), [&](std::size_t i) {
    const std::int64_t time = drive.scan_headers[i].time_ns;
    const std::optional<SE3> pose = world_from_lidar.at(time);
    if (!pose) return;
    const std::vector<Box> boxes = make_boxes(places, time);
    if (std::none_of(boxes.begin(), boxes.end(),
                     [&](const Box& box) { return (box.frame_from_box.t - pose->t).norm() < kMaxRangeM + box.size.norm(); }))
      return;
    Eigen::AlignedBox3d all;
    for (const Box& box : boxes)
      for (const Eigen::Vector3d& corner : box.corners()) all.extend(corner);
    counts[i].assign(boxes.size(), 0);
    for (const map::FilteredScan::Kept& point : map::filter_scan(input, options, i).kept)
      for (std::size_t k = 0; all.contains(point.position) && k < boxes.size(); ++k)
        counts[i][k] += boxes[k].contains(point.position) ? 1 : 0;
  });
  std::vector<std::size_t> sum(places.along.size(), 0);
  for (const std::vector<std::size_t>& of_scan : counts)
    for (std::size_t k = 0; k < of_scan.size(); ++k) sum[k] += of_scan[k];
  return sum;
}

}  // namespace dvi::holdout
