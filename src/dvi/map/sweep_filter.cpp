#include "dvi/map/sweep_filter.h"

#include <algorithm>
#include <cmath>

#include "dvi/drive/deskew.h"

namespace dvi::map {
namespace {

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

class Filter {
 public:
  Filter(const MapInput& input, const MapOptions& options) : input_(input), options_(options) {}

  FilteredSweep operator()(std::size_t index) const {
    const Sweep& sweep = input_.drive->sweeps[index];
    const std::shared_ptr<const Scan> scan = input_.drive->scans[index];
    FilteredSweep out;
    out.counts.returns = scan->size();
    const std::vector<Eigen::Vector3d> world = to_world(*scan, sweep, input_.world_from_lidar);
    if (world.empty()) {
      out.counts.sweeps_without_pose = 1;
      return out;
    }
    out.counts.sweeps = 1;
    if (const std::optional<SE3> middle = input_.world_from_lidar.at(sweep.time_ns)) out.sensor = middle->t.cast<float>();
    const std::optional<Witness> witness = witness_of(sweep, input_);
    const std::shared_ptr<const cv::Mat1b> mask = witness ? input_.masks[witness->frame] : nullptr;
    for (std::size_t i = 0; i < world.size(); ++i) {
      const float range = scan->points[i].norm();
      if (range < options_.min_range_m || range > options_.max_range_m)
        ++out.counts.too_near;
      else if (witness && boxed(*witness, world[i]))
        drop(world[i], Cause::boxed, out.counts.boxed, out);
      else
        judge(world[i], scan->intensity[i], witness, mask.get(), out);
    }
    return out;
  }

 private:
  bool boxed(const Witness& witness, const Eigen::Vector3d& point) const {
    if (input_.objects.empty()) return false;
    const Eigen::Vector3d in_lidar = witness.lidar_from_world * point;
    const std::vector<Label>& labels = input_.objects[witness.frame];
    return std::any_of(labels.begin(), labels.end(),
                       [&](const Label& l) { return l.box && l.box->contains(in_lidar, options_.box_margin_m); });
  }

  static void drop(const Eigen::Vector3d& point, Cause cause, std::size_t& count, FilteredSweep& out) {
    ++count;
    out.removed.push_back({point.cast<float>(), cause});
  }

  void judge(const Eigen::Vector3d& point, float intensity, const std::optional<Witness>& witness, const cv::Mat1b* mask,
             FilteredSweep& out) const {
    bool seen = false;
    if (witness) {
      const Camera& camera = input_.drive->camera;
      const Eigen::Vector3d in_camera = witness->camera_from_world * point;
      if (camera.in_front(in_camera)) {
        const Eigen::Vector2d pixel = camera.project(in_camera);
        seen = camera.contains(pixel);
        if (seen && (*mask)(cvRound(pixel.y()), cvRound(pixel.x())) != 0) {
          drop(point, Cause::masked, out.counts.masked, out);
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

}  // namespace

FilteredSweep filter_sweep(const MapInput& input, const MapOptions& options, std::size_t index) {
  return Filter(input, options)(index);
}

}  // namespace dvi::map
