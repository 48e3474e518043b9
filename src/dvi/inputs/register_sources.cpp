#include "dvi/inputs/register_sources.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/inputs/near_target.h"

namespace dvi::inputs {
namespace {

constexpr double kFarFromGiven = 5;  // meters: given poses that lie farther off are of another world
constexpr const char* kRemedy = "leave it out, or give both drives poses in one world (docs/more_drives.md)";

/// The same recording under another name: its first scan is that of the target, point by point.
bool same_scans(const Drive& a, const Drive& b) {
  if (a.scan_headers.empty() || b.scan_headers.empty()) return false;
  if (a.scan_headers.front().time_ns != b.scan_headers.front().time_ns) return false;
  return a.scans[0]->points == b.scans[0]->points;
}

void require_another(const Drive& target, const Drive& source) {
  if (fs::weakly_canonical(target.path) == fs::weakly_canonical(source.path) || same_scans(target, source))
    throw InputError(source.path, "is the target given as its own source drive",
                     "give another drive of the same street, or none");
}

double nearest_m(const Trajectory& a, const Trajectory& b) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const StampedPose& p : a.poses())
    for (const StampedPose& q : b.poses()) nearest = std::min(nearest, (p.world_from_body.t - q.world_from_body.t).norm());
  return nearest;
}

/// Whether scans can place a drive: those of a LiDAR, which stands on the ground.
bool has_scans(const Drive& drive, const Trajectory& world_from_lidar) {
  return drive.sensor == Sensor::lidar && !drive.scan_headers.empty() && !world_from_lidar.empty();
}

std::string agreement(const registration::PlacementFigures& figures) {
  return fmt::format("{} of {} single things agree", figures.landmark_inliers, figures.landmarks);
}

/// Why a source drive cannot be placed, whose poses say nothing of where it lies.
[[noreturn]] void refuse(const Drive& target, const Drive& source, const registration::PlacementFigures& figures) {
  const std::string name = target.path.filename().string();
  if (figures.overlap > 0)
    throw InputError(source.path, fmt::format("overlaps with {} in {:.0f} % of its scans only", name, 100 * figures.overlap),
                     kRemedy);
  if (figures.second_best_ratio > 0.6 && figures.landmark_inliers > 0)
    throw InputError(
        source.path,
        fmt::format("fits {} in several places equally well, so its overlap cannot be told (0 % is sure; in the best "
                    "place {})",
                    name, agreement(figures)),
        kRemedy);
  throw InputError(
      source.path,
      fmt::format("does not overlap with {}: no scan of it surely shows the same street (0 %; in the best place {})", name,
                  agreement(figures)),
      kRemedy);
}

bool keeps_given(const job::Job& job) {
  return job.read.poses.kind == job::PosesFrom::Kind::given || job.read.poses.kind == job::PosesFrom::Kind::file;
}

/// A source drive that is to be registered.
struct Unplaced {
  std::size_t recording = 0;
  registration::DriveTrack track;
};

std::vector<Unplaced> to_register(const Recordings& drives, const Poses& poses, bool keep_given) {
  const Drive& target = drives.front().drive;
  const std::string name = target.path.filename().string();
  const Trajectory& target_track = poses.front().world_from_lidar;
  std::vector<Unplaced> out;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Drive& source = drives[i].drive;
    const Trajectory& track = poses[i].world_from_lidar;
    require_another(target, source);
    const bool shared = shares_world(target, source);
    if (shared && !time_near_target(target, source))
      throw InputError(source.path,
                       fmt::format("does not overlap with {} (0 %): by the given poses it comes no nearer than {:.0f} m", name,
                                   nearest_m(target_track, track)),
                       "give a source drive of the same street, or take away poses that are not of one world");
    if (shared && keep_given) continue;
    if (has_scans(target, target_track) && has_scans(source, track))
      out.push_back({i, {&source, track, shared}});
    else if (!shared)
      throw InputError(source.path, "cannot be placed in " + name + " by LiDAR scans", kRemedy);
  }
  return out;
}

void take(registration::Placement placement, bool shared, const Drive& target, const Drive& source, DrivePoses& poses,
          Progress& progress) {
  const std::string name = source.path.filename().string();
  if (!placement.found()) {
    if (!shared) refuse(target, source, placement.figures);
    progress.warn(fmt::format("{}: scans do not confirm that its given poses are of the target's world ({}): they are kept",
                              name, agreement(placement.figures)));
    return;
  }
  if (const double off = placement.figures.target_from_source.t.norm(); shared && off > kFarFromGiven)
    progress.warn(fmt::format(
        "{}: its scans put it {:.1f} m from where its given poses do, which are not of the target's world", name, off));
  poses.placed = placement.figures;
  poses.world_from_lidar = std::move(placement.world_from_lidar);
}

}  // namespace

void register_sources(const Recordings& drives, const job::Job& job, Poses& poses, Progress& progress) {
  const Drive& target = drives.front().drive;
  const std::vector<Unplaced> unplaced = to_register(drives, poses, keeps_given(job));
  if (unplaced.empty()) return;
  std::vector<registration::DriveTrack> tracks;
  for (const Unplaced& one : unplaced) tracks.push_back(one.track);
  registration::Registered found = registration::register_drives({&target, poses.front().world_from_lidar, true}, tracks,
                                                                 job.options.odometry, keeps_given(job), progress.parts());
  progress.end();
  poses.front().world_from_lidar = std::move(found.target);
  for (std::size_t k = 0; k < unplaced.size(); ++k)
    take(std::move(found.sources[k]), unplaced[k].track.shares_world, target, *unplaced[k].track.drive,
         poses[unplaced[k].recording], progress);
}

}  // namespace dvi::inputs
