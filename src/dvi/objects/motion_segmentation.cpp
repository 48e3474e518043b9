#include "dvi/objects/motion_segmentation.h"

#include <utility>

#include "dvi/core/threads.h"
#include "dvi/objects/box_returns.h"
#include "dvi/objects/contradictions.h"
#include "dvi/objects/occluded_returns.h"
#include "dvi/objects/stationary_phases.h"
#include "dvi/objects/track_outlines.h"

namespace dvi::objects {

MotionSegmentation segment_motion(MovingReturns& returns, const Tick& tick) {
  Tracker tracker;
  std::vector<Contradictions> contradictions(returns.scans());
  for_blocks(returns.scans(), [&](std::size_t first, std::size_t last) {
    std::vector<std::vector<Cluster>> clusters(last - first);
    parallel_for(clusters.size(), [&](std::size_t i) {
      const ObstacleReturns found = returns.vote(first + i);
      contradictions[first + i] = find_contradictions(found);
      clusters[i] = find_clusters(found);
      for (Cluster& cluster : clusters[i]) cluster.scan = first + i;
    });
    for (std::size_t i = first; i < last; ++i) {
      tracker.add(std::move(clusters[i - first]));
      tick();
    }
  });
  MotionSegmentation out{extend_through_stationary_phases(tracker.finish(), returns), {}};
  out.contradictory_scans = find_contradictory_scans(contradictions, out.tracks);
  for (const std::size_t scan : out.contradictory_scans) {
    returns.distrust(scan);
    for (Track& track : out.tracks) std::erase_if(track.observations, [&](const Cluster& o) { return o.scan == scan; });
  }
  std::erase_if(out.tracks, [](const Track& track) { return !is_moving_object(track); });
  out.tracks = add_occluded_returns(collect_box_returns(out.tracks, returns), returns);
  return out;
}

FrameLabels draw_outlines(const std::vector<Track>& tracks, const Drive& drive, const Trajectory& world_from_lidar,
                          double footprint_m) {
  FrameLabels labels(drive.frames.size());
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const std::int64_t time = drive.frames[i].time_ns;
    const auto pose = world_from_lidar.at(time);
    if (!pose) return;
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      auto label = draw_outline(tracks[k], time, {drive.camera, *pose, drive.camera_from_lidar, footprint_m});
      if (!label) continue;
      label->track = static_cast<int>(k);
      labels[i].push_back(std::move(*label));
    }
  });
  return labels;
}

}  // namespace dvi::objects
