#include "dvi/objects/completion/identities.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace dvi::objects {
namespace {

constexpr double kBoxMarginM = 0.3;  // labels and motion have errors

// Counts votes for numbers of objects.
class Votes {
 public:
  void add(int number) { ++counts_[number]; }
  void add_other() { ++others_; }
  // Returns the number with most votes, of equal ones the lowest, if it has at least half of all votes.
  std::optional<int> majority() const {
    std::optional<int> best;
    int most = 0, all = others_;
    for (const auto& [number, count] : counts_) {
      all += count;
      if (count > most) best = number, most = count;
    }
    return 2 * most >= all ? best : std::nullopt;
  }

 private:
  std::map<int, int> counts_;
  int others_ = 0;
};

// Finds the labeled objects at positions.
class LabelFinder {
 public:
  explicit LabelFinder(const CameraMaskEvidence& labeled) : labeled_(labeled) {
    for (const std::vector<Label>& frame : *labeled.labels)
      for (const Label& label : frame) next_ = std::max(next_, label.track + 1);
  }

  int next_number() const { return next_; }

  std::optional<int> find(const Eigen::Vector3d& world, std::int64_t time_ns) {
    const auto [entry, is_new] = frames_.try_emplace(time_ns);
    if (is_new) entry->second = collect_boxes(time_ns);
    for (const TrackBox& box : entry->second)
      if (box.world.contains(world, kBoxMarginM)) return box.track;
    return std::nullopt;
  }

 private:
  struct TrackBox {
    int track;
    Box world;
  };

  std::vector<TrackBox> collect_boxes(std::int64_t time_ns) const {
    std::vector<TrackBox> out;
    const std::optional<MaskedFrame> frame = find_masked_frame(labeled_, time_ns);
    if (!frame) return out;
    const SE3 world_from_lidar = frame->lidar_from_world.inverse();
    for (const Label& label : *frame->labels)
      if (label.track >= 0 && label.box)
        out.push_back({label.track, {world_from_lidar * label.box->frame_from_box, label.box->size}});
    return out;
  }

  const CameraMaskEvidence& labeled_;
  std::map<std::int64_t, std::vector<TrackBox>> frames_;  // by time of the scan
  int next_ = 0;
};

using VoxelIndex = std::tuple<int, int, int>;

VoxelIndex to_tuple(const Eigen::Vector3i& index) { return {index.x(), index.y(), index.z()}; }

// Finds the tracks that observe voxels, scan by scan.
class TrackFinder {
 public:
  TrackFinder(const std::vector<SharedTrack>& tracks, std::size_t scans) : observations_(scans) {
    for (std::size_t k = 0; k < tracks.size(); ++k)
      for (const Cluster& observation : tracks[k]->observations) observations_[observation.scan].emplace_back(k, &observation);
  }

  // Returns the track of each voxel with returns of tracks in a scan, of several the first.
  std::map<VoxelIndex, std::size_t> find(std::size_t scan) const {
    std::map<VoxelIndex, std::size_t> out;
    for (const auto& [track, observation] : observations_[scan])
      for (const ClusterReturn& r : observation->returns) out.try_emplace(to_tuple(voxel_at(r.point)), track);
    return out;
  }

 private:
  std::vector<std::vector<std::pair<std::size_t, const Cluster*>>> observations_;  // per scan, with the index of the track
};

// Lists, per scan, the voxels in which masks show an object.
std::vector<std::vector<std::uint32_t>> list_by_scan(const std::vector<OccupiedVoxel>& voxels, std::size_t scans) {
  std::vector<std::vector<std::uint32_t>> out(scans);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    for (const std::uint32_t scan : voxels[i].evidence) out[scan].push_back(static_cast<std::uint32_t>(i));
  return out;
}

}  // namespace

Identities identify(const CameraMaskEvidence& labeled, const ObjectParts& parts) {
  Identities out;
  LabelFinder labels(labeled);
  int next = labels.next_number();
  for (const SharedTrack& track : parts.tracks) {
    Votes votes;
    for (const Cluster& observation : track->observations) {
      const Eigen::Vector3d middle = observation.returns[observation.returns.size() / 2].point;
      if (const auto number = labels.find(middle, parts.returns.time_ns(observation.scan)))
        votes.add(*number);
      else
        votes.add_other();
    }
    const std::optional<int> number = votes.majority();
    out.of_track.push_back(number ? *number : next++);
  }
  const TrackFinder tracks(parts.tracks, parts.returns.scans());
  const std::vector<std::vector<std::uint32_t>> observed = list_by_scan(parts.voxels, parts.returns.scans());
  std::map<int, Votes> votes;  // by group
  for (std::size_t scan = 0; scan < observed.size(); ++scan) {
    const std::map<VoxelIndex, std::size_t> track_of = tracks.find(scan);
    for (const std::uint32_t i : observed[scan]) {
      const OccupiedVoxel& voxel = parts.voxels[i];
      const auto track = track_of.find(to_tuple(voxel.index));
      if (const auto number = labels.find(voxel.center(), parts.returns.time_ns(scan)))
        votes[voxel.object].add(*number);
      else if (track != track_of.end())
        votes[voxel.object].add(out.of_track[track->second]);
      else
        votes[voxel.object].add_other();
    }
  }
  std::map<int, int> of_group;
  for (const auto& [group, vote] : votes) {
    const std::optional<int> number = vote.majority();
    of_group[group] = number ? *number : next++;
  }
  for (const OccupiedVoxel& voxel : parts.voxels) out.of_voxel.push_back(of_group.at(voxel.object));
  return out;
}

}  // namespace dvi::objects
