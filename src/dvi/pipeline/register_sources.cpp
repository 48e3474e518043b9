#include "dvi/pipeline/register_sources.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::pipeline {
namespace {

constexpr double kFarApart = 150;    // metres between trajectories: no camera sees what the other drive saw
constexpr double kFarFromGiven = 5;  // metres: given poses that lie farther off are of another world
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
  return fmt::format("{} of {} single things agree", figures.things_agree, figures.things);
}

/// Why a source drive cannot be placed, whose poses say nothing of where it lies.
[[noreturn]] void refuse(const Drive& target, const Drive& source, const registration::PlacementFigures& figures) {
  const std::string name = target.path.filename().string();
  if (figures.overlap > 0)
    throw InputError(source.path, fmt::format("overlaps with {} in {:.0f} % of its scans only", name, 100 * figures.overlap),
                     kRemedy);
  if (figures.rival > 0.6 && figures.things_agree > 0)
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

}  // namespace

void register_sources(const Recordings& drives, const Job& job, Poses& poses, Progress& progress) {
  if (poses.size() < 2) return;
  const Drive& target = drives.front().drive;
  const bool keep_given = job.read.poses.kind == PosesFrom::Kind::given || job.read.poses.kind == PosesFrom::Kind::file;
  std::vector<registration::DriveTrack> tracks;
  std::vector<std::size_t> which;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Drive& source = drives[i].drive;
    require_another(target, source);
    const bool shared = shares_world(target, source);
    if (shared) {
      if (const double apart = nearest_m(poses.front().world_from_lidar, poses[i].world_from_lidar); apart > kFarApart)
        throw InputError(source.path,
                         fmt::format("does not overlap with {} (0 %): by the given poses it comes no nearer than {:.0f} m",
                                     target.path.filename().string(), apart),
                         "give a source drive of the same street, or take away poses that are not of one world");
      if (keep_given) continue;
    }
    if (has_scans(target, poses.front().world_from_lidar) && has_scans(source, poses[i].world_from_lidar)) {
      tracks.push_back({&source, poses[i].world_from_lidar, shared});
      which.push_back(i);
    } else if (!shared) {
      throw InputError(source.path, "cannot be placed in " + target.path.filename().string() + " by LiDAR scans", kRemedy);
    }
  }
  if (tracks.empty()) return;
  registration::Registered found = registration::register_drives({&target, poses.front().world_from_lidar, true}, tracks,
                                                                 job.options.odometry, keep_given, progress.parts());
  progress.end();
  poses.front().world_from_lidar = std::move(found.target);
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    const Drive& source = *tracks[k].drive;
    registration::Placement& placement = found.sources[k];
    if (placement.found()) {
      if (const double off = placement.figures.target_from_source.t.norm(); tracks[k].shares_world && off > kFarFromGiven)
        progress.warn(
            fmt::format("{}: its scans put it {:.1f} m from where its given poses do, which are not of the target's world",
                        source.path.filename().string(), off));
      poses[which[k]].placed = placement.figures;
      poses[which[k]].world_from_lidar = std::move(placement.world_from_lidar);
    } else if (tracks[k].shares_world) {
      progress.warn(fmt::format("{}: scans do not confirm that its given poses are of the target's world ({}): they are kept",
                                source.path.filename().string(), agreement(placement.figures)));
    } else {
      refuse(target, source, placement.figures);
    }
  }
}

}  // namespace dvi::pipeline
