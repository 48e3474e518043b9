#include "dvi/map/scan_filter.h"

#include <algorithm>
#include <cmath>

#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/drive/removed_at.h"

namespace dvi::map {
namespace {

/// The frame nearest in time to a scan, with its pose and mask.
struct NearestFrame {
  std::size_t frame = 0;
  SE3 lidar_from_world;
  SE3 camera_from_world;
  const Camera* camera = nullptr;
  std::shared_ptr<const cv::Mat1b> mask;
};

InImage in_image(const Eigen::Vector3d& point, const NearestFrame& frame) {
  return dvi::in_image(frame.camera_from_world * point, *frame.camera, *frame.mask);
}

std::optional<NearestFrame> find_nearest_frame(const ScanHeader& header, const Drive& drive, const Lazy<cv::Mat1b>& masks,
                                               const Trajectory& world_from_lidar) {
  const std::vector<Frame>& frames = drive.frames;
  const Frame* const nearest = nearest_in_time(frames, header.time_ns, header.end_ns - header.start_ns);
  if (!nearest) return std::nullopt;
  const std::optional<SE3> pose = world_from_lidar.at(nearest->time_ns);
  if (!pose) return std::nullopt;
  const SE3 lidar_from_world = pose->inverse();
  const auto frame = static_cast<std::size_t>(nearest - frames.data());
  return NearestFrame{frame, lidar_from_world, drive.camera_from_lidar * lidar_from_world, &drive.camera, masks[frame]};
}

class ScanFilter {
 public:
  ScanFilter(const MapInput& input, const MapOptions& options) : input_(input), options_(options) {}

  FilteredScan filter(std::size_t index) const {
    const ScanHeader& header = input_.drive->scan_headers[index];
    const std::shared_ptr<const Scan> scan = input_.drive->scans[index];
    FilteredScan out;
    out.counts.returns = scan->size();
    const std::vector<Eigen::Vector3d> world = to_world(*scan, header, input_.world_from_lidar);
    if (world.empty()) {
      out.counts.scans_without_pose = 1;
      return out;
    }
    out.counts.scans = 1;
    if (const std::optional<SE3> middle = input_.world_from_lidar.at(header.time_ns)) out.sensor = middle->t.cast<float>();
    const std::optional<NearestFrame> nearest =
        find_nearest_frame(header, *input_.drive, input_.masks, input_.world_from_lidar);
    std::vector<NearestFrame> more;
    for (const MapCamera& camera : input_.more_cameras)
      if (auto frame = find_nearest_frame(header, *camera.drive, camera.masks, input_.world_from_lidar))
        more.push_back(std::move(*frame));
    const double min_range_m = options_.min_range_m.value_or(input_.drive->min_range_m());
    const double max_range_m = options_.max_range_m.value_or(input_.drive->max_range_m());
    const auto labels = input_.drive->point_labels.empty() ? nullptr : input_.drive->point_labels[index];
    for (std::size_t i = 0; i < world.size(); ++i) {
      const float range = scan->points[i].norm();
      if (range < min_range_m || range > max_range_m)
        ++out.counts.too_near;
      else if ((labels && labels->values[i] != 0) || (nearest && is_boxed(*nearest, world[i])))
        drop(world[i], Cause::boxed, out.counts.boxed, out);
      else
        judge({world[i], scan->intensity[i]}, nearest, more, out);
    }
    return out;
  }

 private:
  bool is_boxed(const NearestFrame& nearest, const Eigen::Vector3d& point) const {
    if (!input_.objects) return false;
    return is_in_any_box((*input_.objects)[nearest.frame], nearest.lidar_from_world * point, options_.box_margin_m);
  }

  static void drop(const Eigen::Vector3d& point, Cause cause, std::size_t& count, FilteredScan& out) {
    ++count;
    out.removed.push_back({point.cast<float>(), cause});
  }

  void judge(const FilteredScan::Kept& point, const std::optional<NearestFrame>& nearest, const std::vector<NearestFrame>& more,
             FilteredScan& out) const {
    InImage observation = nearest ? in_image(point.position, *nearest) : InImage::unseen;
    for (const NearestFrame& other : more)
      if (observation != InImage::background) observation = std::max(observation, in_image(point.position, other));
    if (observation == InImage::removed)
      drop(point.position, Cause::masked, out.counts.masked, out);
    else if (observation == InImage::unseen && options_.require_camera_visibility)
      ++out.counts.unseen_by_camera;
    else
      out.kept.push_back(point);
  }

  const MapInput& input_;
  const MapOptions& options_;
};

}  // namespace

FilteredScan filter_scan(const MapInput& input, const MapOptions& options, std::size_t index) {
  return ScanFilter(input, options).filter(index);
}

}  // namespace dvi::map
