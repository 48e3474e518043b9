#include "dvi/objects/motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace dvi::objects {
namespace {

constexpr double kStill = 0.3;              // meters: doors, people who shift their weight
constexpr double kBoxError = 0.1;           // meters, of a box by hand or by a detector
constexpr double kBoxErrorPerMeter = 0.01;  // of its distance: fewer returns tell where it ends
constexpr double kSettled = 1;              // seconds after which a box's errors no longer resemble each other
constexpr double kSigmas = 3;
constexpr std::size_t kMostPlaces = 100;  // of a track, evenly spread: pairs are compared

struct Sight {
  std::size_t frame;
  double seconds;
  Eigen::Vector2d place;  // world axes
  double error;           // meters, one sigma
};

struct Seen {
  std::string type;
  std::vector<Sight> sights;
};

std::map<int, Seen> sights_of(const Drive& drive, const FrameLabels& labels, const Trajectory& world_from_lidar) {
  std::map<int, Seen> tracks;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const Frame& frame = drive.frames[i];
    const std::optional<SE3> pose = world_from_lidar.at(frame.time_ns);
    if (!pose) continue;
    for (const Label& label : labels[i]) {
      if (label.track < 0 || !label.box) continue;
      const Eigen::Vector3d& center = label.box->frame_from_box.t;
      Seen& seen = tracks[label.track];
      seen.type = label.type;
      seen.sights.push_back({i, 1e-9 * static_cast<double>(frame.time_ns), (*pose * center).head<2>(),
                             kBoxError + kBoxErrorPerMeter * center.norm()});
    }
  }
  return tracks;
}

// Of how far two places lie apart. Boxes of frames shortly after each other are wrong alike.
double sigma_between(const Sight& a, const Sight& b) {
  const double alike = std::sqrt(std::min(1.0, std::abs(b.seconds - a.seconds) / kSettled));
  return alike * std::hypot(a.error, b.error);
}

TrackMotion motion_of(int track, const Seen& seen) {
  const std::vector<Sight>& sights = seen.sights;
  TrackMotion out{
      .track = track, .type = seen.type, .first = sights.front().frame, .last = sights.back().frame, .frames = sights.size()};
  const std::size_t step = (sights.size() + kMostPlaces - 1) / kMostPlaces;
  double surest = 0;
  for (std::size_t a = 0; a < sights.size(); a += step)
    for (std::size_t b = a + step; b < sights.size(); b += step) {
      const double way = (sights[b].place - sights[a].place).norm(), sigma = sigma_between(sights[a], sights[b]);
      const double sure = way / (kStill + kSigmas * sigma);
      if (sure <= surest) continue;
      surest = sure;
      out.way_m = way;
      out.way_sigma_m = sigma;
      out.speed_mps = way / std::max(1e-3, sights[b].seconds - sights[a].seconds);
    }
  out.moves = surest > 1;
  return out;
}

}  // namespace

std::vector<TrackMotion> track_motions(const Drive& drive, const FrameLabels& labels, const Trajectory& world_from_lidar) {
  std::vector<TrackMotion> out;
  for (const auto& [track, seen] : sights_of(drive, labels, world_from_lidar)) out.push_back(motion_of(track, seen));
  return out;
}

std::set<int> stationary_tracks(const Drive& drive, const Trajectory& world_from_lidar) {
  std::set<int> standing;
  for (const TrackMotion& motion : track_motions(drive, drive.labels(), world_from_lidar))
    if (!motion.moves) standing.insert(motion.track);
  return standing;
}

FrameLabels without_stationary(const Drive& drive, const Trajectory& world_from_lidar) {
  const std::set<int> standing = stationary_tracks(drive, world_from_lidar);
  FrameLabels labels = drive.labels();
  for (std::vector<Label>& frame : labels) std::erase_if(frame, [&](const Label& l) { return standing.contains(l.track); });
  return labels;
}

}  // namespace dvi::objects
