#include "dvi/objects/motion_segmentation.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "dvi/core/threads.h"
#include "dvi/drive/point_labels.h"
#include "dvi/objects/box_returns.h"
#include "dvi/objects/contradictions.h"
#include "dvi/objects/occluded_returns.h"
#include "dvi/objects/stationary_phases.h"
#include "dvi/objects/track_outlines.h"

namespace dvi::objects {
namespace {

// Number of consecutive scans that are compared with others at a time. Where the memory for caches is small, each of the others
// is read once for all of them: with 16, up to 3.5 scans are read per scan.
constexpr std::size_t kVotedScans = 16;

}  // namespace

MotionSegmentation segment_motion(MovingReturns& returns, const Tick& tick) {
  Tracker tracker;
  std::vector<Contradictions> contradictions(returns.scans());
  for (std::size_t first = 0; first < returns.scans(); first += kVotedScans) {
    const std::vector<ObstacleReturns> found = returns.vote(first, std::min(first + kVotedScans, returns.scans()));
    const auto find = [&](std::size_t k) {
      contradictions[first + k] = find_contradictions(found[k]);
      std::vector<Cluster> clusters = find_clusters(found[k]);
      for (Cluster& cluster : clusters) cluster.scan = first + k;
      return clusters;
    };
    make_and_use(found.size(), find, [&](std::size_t, std::vector<Cluster> clusters) {
      tracker.add(std::move(clusters));
      tick();
    });
  }
  MotionSegmentation out{extend_through_stationary_phases(tracker.finish(), returns), {}};
  out.contradictory_scans = find_contradictory_scans(contradictions, out.tracks);
  for (const std::size_t scan : out.contradictory_scans) {
    returns.distrust(scan);
    for (Track& track : out.tracks) std::erase_if(track.observations, [&](const Cluster& o) { return o.scan == scan; });
  }
  std::erase_if(out.tracks, [](const Track& track) { return !is_moving_object(track); });
  out.tracks = add_occluded_returns(collect_box_returns(std::move(out.tracks), returns), returns);
  return out;
}

std::vector<Track> track_labeled(const MovingReturns& returns, const Tick& tick) {
  Tracker tracker([](const Track&) { return true; });
  const auto find = [&](std::size_t scan) {
    std::vector<Cluster> clusters = find_labeled_clusters(*returns.obstacles(scan));
    for (Cluster& cluster : clusters) cluster.scan = scan;
    return clusters;
  };
  make_and_use(returns.scans(), find, [&](std::size_t, std::vector<Cluster> clusters) {
    tracker.add(std::move(clusters));
    tick();
  });
  std::vector<Track> tracks = tracker.finish();
  for (Track& track : tracks) estimate_extent(track);
  return add_occluded_returns(std::move(tracks), returns);
}

bool is_moving_labeled(const Track& track) {
  const auto moves = [](const Cluster& cluster) { return is_moving_point_class(cluster.label_class); };
  const auto moving = std::count_if(track.observations.begin(), track.observations.end(), moves);
  return 2 * static_cast<std::size_t>(moving) > track.observations.size();
}

std::string label_type(const Track& track) {
  std::map<std::string_view, std::size_t> counts;
  for (const Cluster& cluster : track.observations)
    if (const PointClass* found = find_point_class(cluster.label_class)) ++counts[found->type];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? "" : std::string(most->first);
}

FrameLabels draw_outlines(std::span<const Track> tracks, const Drive& drive, const Trajectory& world_from_lidar,
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
