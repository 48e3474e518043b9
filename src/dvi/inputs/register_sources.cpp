#include "dvi/inputs/register_sources.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/inputs/near_target.h"

namespace dvi::inputs {
namespace {

constexpr double kMaxGivenErrorM = 5;       // given poses with a larger error are in another world
constexpr double kMinAmbiguousRatio = 0.6;  // second-best to best place
constexpr const char* kRemedy = "leave it out, or give both drives poses in one world (docs/more_drives.md)";

/// Whether both are the same recording under two names: the first scans have the same time and points.
bool has_same_scans(const Drive& a, const Drive& b) {
  if (a.scan_headers.empty() || b.scan_headers.empty()) return false;
  if (a.scan_headers.front().time_ns != b.scan_headers.front().time_ns) return false;
  return a.scans[0]->points == b.scans[0]->points;
}

void require_different_drives(const Drive& target, const Drive& source) {
  if (fs::weakly_canonical(target.path) == fs::weakly_canonical(source.path) || has_same_scans(target, source))
    throw InputError(source.path, "is the target given as its own source drive",
                     "give another drive of the same street, or none");
}

double min_distance_m(const Trajectory& a, const Trajectory& b) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const StampedPose& p : a.poses())
    for (const StampedPose& q : b.poses()) nearest = std::min(nearest, (p.world_from_body.t - q.world_from_body.t).norm());
  return nearest;
}

/// Whether a drive can be registered by its scans: those of a LiDAR on a vehicle.
bool can_register(const Drive& drive, const Trajectory& world_from_lidar) {
  return drive.sensor == Sensor::lidar && !drive.scan_headers.empty() && !world_from_lidar.empty();
}

std::string describe_inliers(const registration::PlacementFigures& figures) {
  return fmt::format("{} of {} landmarks are inliers", figures.landmark_inliers, figures.landmarks);
}

/// Throws InputError with the reason why a source drive without poses in the target's world cannot be registered.
[[noreturn]] void refuse(const Drive& target, const Drive& source, const registration::PlacementFigures& figures) {
  const std::string name = target.path.filename().string();
  if (figures.overlap > 0)
    throw InputError(source.path, fmt::format("overlaps with {} in only {:.0f} % of its scans", name, 100 * figures.overlap),
                     kRemedy);
  if (figures.second_best_ratio > kMinAmbiguousRatio && figures.landmark_inliers > 0)
    throw InputError(
        source.path,
        fmt::format("fits {} in several places equally well, so its overlap cannot be determined (0 % is certain; in the best "
                    "place, {})",
                    name, describe_inliers(figures)),
        kRemedy);
  throw InputError(
      source.path,
      fmt::format("does not overlap with {}: no scan of it certainly shows the same street (0 %; in the best place, {})", name,
                  describe_inliers(figures)),
      kRemedy);
}

/// Whether given poses in the target's world are used without registration.
bool keeps_given(const job::Job& job) {
  return job.read.poses.kind == job::PosesFrom::Kind::given || job.read.poses.kind == job::PosesFrom::Kind::file;
}

/// A source drive that is to be registered.
struct Unplaced {
  std::size_t recording = 0;
  registration::DriveTrack track;
};

/// Lists the source drives to register. Throws InputError for those that cannot be placed.
std::vector<Unplaced> find_unplaced(const Recordings& drives, const Poses& poses, const job::Job& job) {
  const Drive& target = drives.front().drive;
  const std::string name = target.path.filename().string();
  const Trajectory& target_track = poses.front().world_from_lidar;
  std::vector<Unplaced> out;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Drive& source = drives[i].drive;
    const Trajectory& track = poses[i].world_from_lidar;
    require_different_drives(target, source);
    const bool shared = shares_world(target, source);
    if (shared && !time_near_target(target, source))
      throw InputError(source.path,
                       fmt::format("does not overlap with {} (0 %): by the given poses its distance is at least {:.0f} m", name,
                                   min_distance_m(target_track, track)),
                       "give a source drive of the same street, or remove poses that are not in one world");
    if (shared && keeps_given(job)) continue;
    if (can_register(target, target_track) && can_register(source, track))
      out.push_back({i, {&source, track, shared}});
    else if (!shared)
      throw InputError(source.path, "cannot be registered to " + name + " by LiDAR scans", kRemedy);
  }
  return out;
}

/// Sets the poses of a source drive to those of its registration; returns a warning about its given poses, if any.
std::optional<std::string> apply_registration(registration::Placement placement, const registration::DriveTrack& source,
                                              const Drive& target, DrivePoses& poses) {
  const std::string name = source.drive->path.filename().string();
  if (!placement.found()) {
    if (!source.shares_world) refuse(target, *source.drive, placement.figures);
    return fmt::format("{}: scans do not confirm that its given poses are in the target's world ({}): they are kept", name,
                       describe_inliers(placement.figures));
  }
  const double error_m = placement.figures.target_from_source.t.norm();
  poses.placed = placement.figures;
  poses.world_from_lidar = std::move(placement.world_from_lidar);
  if (!source.shares_world || error_m <= kMaxGivenErrorM) return std::nullopt;
  return fmt::format("{}: registration by scans places it {:.1f} m from its given poses, which are not in the target's world",
                     name, error_m);
}

}  // namespace

void register_sources(const Recordings& drives, const job::Job& job, Poses& poses, Progress& progress) {
  const Drive& target = drives.front().drive;
  const std::vector<Unplaced> unplaced = find_unplaced(drives, poses, job);
  if (unplaced.empty()) return;
  std::vector<registration::DriveTrack> tracks;
  for (const Unplaced& one : unplaced) tracks.push_back(one.track);
  registration::Registered found = registration::register_drives(
      {&target, poses.front().world_from_lidar, true, keeps_given(job)}, tracks, job.options.odometry, progress.parts());
  progress.end();
  poses.front().world_from_lidar = std::move(found.target);
  for (std::size_t k = 0; k < unplaced.size(); ++k)
    if (const auto warning =
            apply_registration(std::move(found.sources[k]), unplaced[k].track, target, poses[unplaced[k].recording]))
      progress.warn(*warning);
}

}  // namespace dvi::inputs
