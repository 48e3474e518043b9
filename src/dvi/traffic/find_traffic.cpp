#include "dvi/traffic/find_traffic.h"

#include "dvi/core/threads.h"
#include "dvi/traffic/complete.h"
#include "dvi/traffic/follow.h"
#include "dvi/traffic/outlines.h"

namespace dvi::traffic {

Traffic find_traffic(const Drive& drive, const Trajectory& world_from_lidar, const Ground& ground, const Allowances& allowances,
                     const Tick& tick) {
  const MovingReturns returns(drive, world_from_lidar, ground, allowances.pose_error_m);
  Tracker tracker;
  for_blocks(drive.scan_headers.size(), [&](std::size_t first, std::size_t last) {
    std::vector<std::vector<Cluster>> clusters(last - first);
    parallel_for(clusters.size(), [&](std::size_t i) { clusters[i] = clusters_of(returns.find(first + i)); });
    for (std::size_t i = first; i < last; ++i) {
      tracker.add(std::move(clusters[i - first]));
      tick();
    }
  });
  Traffic traffic{completed(followed(tracker.finish(), returns), returns), FrameLabels(drive.frames.size())};
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const std::int64_t time = drive.frames[i].time_ns;
    const auto pose = world_from_lidar.at(time);
    if (!pose) return;
    for (std::size_t k = 0; k < traffic.tracks.size(); ++k) {
      auto label = outline(traffic.tracks[k], time, drive.camera, *pose, drive.camera_from_lidar, allowances.footprint_m);
      if (!label) continue;
      label->track = static_cast<int>(k);
      traffic.labels[i].push_back(std::move(*label));
    }
  });
  return traffic;
}

}  // namespace dvi::traffic
