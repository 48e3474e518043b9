#include "dvi/traffic/find_traffic.h"

#include "dvi/core/threads.h"
#include "dvi/traffic/complete.h"
#include "dvi/traffic/follow.h"
#include "dvi/traffic/outlines.h"

namespace dvi::traffic {

std::vector<Track> find_traffic(const Drive& drive, const Trajectory& world_from_lidar, const Ground& ground,
                                double pose_error_m, const Tick& tick) {
  const MovingReturns returns(drive, world_from_lidar, ground, pose_error_m);
  Tracker tracker;
  for_blocks(drive.scan_headers.size(), [&](std::size_t first, std::size_t last) {
    std::vector<std::vector<Cluster>> clusters(last - first);
    parallel_for(clusters.size(), [&](std::size_t i) { clusters[i] = clusters_of(returns.find(first + i)); });
    for (std::size_t i = first; i < last; ++i) {
      tracker.add(std::move(clusters[i - first]));
      tick();
    }
  });
  return completed(followed(tracker.finish(), returns), returns);
}

FrameLabels outlines(const std::vector<Track>& tracks, const Drive& drive, const Trajectory& world_from_lidar,
                     double footprint_m) {
  FrameLabels labels(drive.frames.size());
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const std::int64_t time = drive.frames[i].time_ns;
    const auto pose = world_from_lidar.at(time);
    if (!pose) return;
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      auto label = outline(tracks[k], time, drive.camera, *pose, drive.camera_from_lidar, footprint_m);
      if (!label) continue;
      label->track = static_cast<int>(k);
      labels[i].push_back(std::move(*label));
    }
  });
  return labels;
}

}  // namespace dvi::traffic
