#include "dvi/objects/motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace dvi::objects {
namespace {

struct MotionStateParams {
  double stationary_displacement_m = 0.3;  ///< stationary objects move by up to this: open doors, people who shift their weight
  double box_sigma_m = 0.1;                ///< standard deviation of a box position, drawn by hand or by a detector
  double box_sigma_per_m = 0.01;           ///< its growth with the distance: fewer returns show the end of the object
  double correlation_s = 1;                ///< time after which the errors of boxes are independent
  double sigmas = 3;                       ///< multiple of the standard deviation that a moving object exceeds
  std::size_t max_positions = 100;         ///< positions of a track that are compared in pairs, evenly spaced
};
constexpr MotionStateParams kMotionState{};

struct BoxPosition {
  std::size_t frame;
  double time_s;
  Eigen::Vector2d position;  // world axes
  double sigma_m;
};

struct LabeledTrack {
  std::string type;
  std::vector<BoxPosition> positions;
};

std::map<int, LabeledTrack> collect_positions(const Drive& drive, const FrameLabels& labels,
                                              const Trajectory& world_from_lidar) {
  std::map<int, LabeledTrack> tracks;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const Frame& frame = drive.frames[i];
    const std::optional<SE3> pose = world_from_lidar.at(frame.time_ns);
    if (!pose) continue;
    for (const Label& label : labels[i]) {
      if (label.track < 0 || !label.box) continue;
      const Eigen::Vector3d& center = label.box->frame_from_box.t;
      LabeledTrack& track = tracks[label.track];
      track.type = label.type;
      track.positions.push_back({i, 1e-9 * static_cast<double>(frame.time_ns), (*pose * center).head<2>(),
                                 kMotionState.box_sigma_m + kMotionState.box_sigma_per_m * center.norm()});
    }
  }
  return tracks;
}

// Estimates the standard deviation of a displacement. The errors of boxes at similar times are correlated.
double estimate_sigma(const BoxPosition& a, const BoxPosition& b) {
  const double independence = std::sqrt(std::min(1.0, std::abs(b.time_s - a.time_s) / kMotionState.correlation_s));
  return independence * std::hypot(a.sigma_m, b.sigma_m);
}

TrackMotion measure_motion(int number, const LabeledTrack& track) {
  const std::vector<BoxPosition>& positions = track.positions;
  TrackMotion out{.track = number,
                  .type = track.type,
                  .first = positions.front().frame,
                  .last = positions.back().frame,
                  .frames = positions.size()};
  const std::size_t step = (positions.size() + kMotionState.max_positions - 1) / kMotionState.max_positions;
  double best_significance = 0;
  for (std::size_t a = 0; a < positions.size(); a += step)
    for (std::size_t b = a + step; b < positions.size(); b += step) {
      const double displacement_m = (positions[b].position - positions[a].position).norm();
      const double sigma_m = estimate_sigma(positions[a], positions[b]);
      const double significance = displacement_m / (kMotionState.stationary_displacement_m + kMotionState.sigmas * sigma_m);
      if (significance <= best_significance) continue;
      best_significance = significance;
      out.displacement_m = displacement_m;
      out.displacement_sigma_m = sigma_m;
      out.speed_mps = displacement_m / std::max(1e-3, positions[b].time_s - positions[a].time_s);
    }
  out.moves = best_significance > 1;
  return out;
}

}  // namespace

std::vector<TrackMotion> measure_track_motions(const Drive& drive, const FrameLabels& labels,
                                               const Trajectory& world_from_lidar) {
  std::vector<TrackMotion> out;
  for (const auto& [number, track] : collect_positions(drive, labels, world_from_lidar))
    out.push_back(measure_motion(number, track));
  return out;
}

std::set<int> find_stationary_tracks(const Drive& drive, const Trajectory& world_from_lidar) {
  std::set<int> stationary;
  for (const TrackMotion& motion : measure_track_motions(drive, drive.labels(), world_from_lidar))
    if (!motion.moves) stationary.insert(motion.track);
  return stationary;
}

FrameLabels remove_stationary(const Drive& drive, const Trajectory& world_from_lidar) {
  const std::set<int> stationary = find_stationary_tracks(drive, world_from_lidar);
  FrameLabels labels = drive.labels();
  for (std::vector<Label>& frame : labels) std::erase_if(frame, [&](const Label& l) { return stationary.contains(l.track); });
  return labels;
}

}  // namespace dvi::objects
