#include "dvi/objects/completion/removed_tracks.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace dvi::objects {
namespace {

struct RemovedTrackParams {
  double min_masked_share = 0.5;     ///< masked share of a track's visible returns in a scan in which masks show it
  std::size_t min_masked_scans = 2;  ///< scans in which masks show a track
  double min_track_share = 0.2;      ///< the same, as a share of the scans in which the track is visible
};
constexpr RemovedTrackParams kRemovedTracks;

// Counts the scans in which masks show a track.
class TrackEvidence {
 public:
  void add(const Cluster& observation, const std::vector<MaskedSurfaces>& images) {
    std::size_t visible = 0, masked = 0;
    for (const MaskedSurfaces& image : images)
      for (const ClusterReturn& r : observation.returns) {
        const std::optional<bool> is_masked = image.shows_masked(r.point);
        visible += is_masked.has_value();
        masked += is_masked.value_or(false);
      }
    if (visible == 0) return;
    ++visible_scans_;
    masked_scans_ += static_cast<double>(masked) >= kRemovedTracks.min_masked_share * static_cast<double>(visible);
  }

  bool is_removed() const {
    return masked_scans_ >= kRemovedTracks.min_masked_scans &&
           static_cast<double>(masked_scans_) >= kRemovedTracks.min_track_share * static_cast<double>(visible_scans_);
  }

 private:
  std::size_t visible_scans_ = 0, masked_scans_ = 0;
};

}  // namespace

std::vector<SharedTrack> find_removed_tracks(const std::vector<CameraMaskEvidence>& cameras, const MovingReturns& returns,
                                             const SharedTracks& tracks) {
  std::vector<std::vector<std::pair<std::size_t, const Cluster*>>> observations(returns.scans());
  for (std::size_t k = 0; k < tracks->size(); ++k)
    for (const Cluster& observation : (*tracks)[k].observations) observations[observation.scan].emplace_back(k, &observation);
  std::vector<TrackEvidence> evidence(tracks->size());
  for (std::size_t scan = 0; scan < observations.size(); ++scan) {
    if (observations[scan].empty()) continue;
    const std::int64_t time_ns = observations[scan].front().second->mean_time_ns;
    std::vector<MaskedSurfaces> images;
    for (const CameraMaskEvidence& camera : cameras)
      if (const auto frame = find_masked_frame(camera, time_ns)) images.emplace_back(*frame, returns.obstacles(scan)->points);
    for (const auto& [track, observation] : observations[scan]) evidence[track].add(*observation, images);
  }
  std::vector<SharedTrack> removed;
  for (std::size_t k = 0; k < tracks->size(); ++k)
    if (evidence[k].is_removed()) removed.push_back(share_track(tracks, k));
  return removed;
}

}  // namespace dvi::objects
