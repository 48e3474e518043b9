#include "dvi/inputs/poses.h"

#include <algorithm>
#include <utility>

#include "dvi/core/error.h"
#include "dvi/inputs/register_sources.h"

namespace dvi::inputs {
namespace {

/// Transforms given positions from the drive's Mercator scale to the target's.
Trajectory scale_to_target(const Drive& target, const Drive& drive) {
  const double scale = target.world_scale / drive.world_scale;
  std::vector<StampedPose> poses = drive.poses.poses();
  for (StampedPose& p : poses) p.world_from_body.t *= scale;
  return Trajectory(std::move(poses));
}

void require_poses(const Recordings& drives, const std::vector<PoseChoice>& choices) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Drive& drive = drives[i].drive;
    if (!trajectory_of(drive, choices[i]).empty()) continue;
    if (i == 0) throw InputError(drive.path, "has no poses", "give --poses FILE (docs/formats.md lists the formats)");
    throw InputError(drive.path, "has neither poses nor scans to register it to " + drives.front().drive.path.string(),
                     "give both drives poses in one world (docs/more_drives.md)");
  }
}

void require_posed_frame(const Drive& drive, const Trajectory& world_from_lidar) {
  if (std::none_of(drive.frames.begin(), drive.frames.end(), [&](const Frame& f) { return world_from_lidar.at(f.time_ns); }))
    throw InputError(drive.path, "no frame has a pose", "check that poses and images share one clock");
}

}  // namespace

bool shares_world(const Drive& target, const Drive& drive) { return !target.poses.empty() && !drive.poses.empty(); }

Poses transform_to_target_world(const Recordings& drives, std::vector<PoseChoice> choices) {
  require_poses(drives, choices);
  const Drive& target = drives.front().drive;
  Poses poses;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Trajectory given = scale_to_target(target, drives[i].drive);
    const bool loam = choices[i].from == PoseOrigin::loam;
    Trajectory trajectory = loam ? align_to_given(given, choices[i].odometry->world_from_lidar) : given;
    poses.push_back({std::move(choices[i]), std::move(trajectory)});
  }
  const Trajectory& first = poses.front().world_from_lidar;
  const std::int64_t start = target.scan_headers.empty() ? target.frames.front().time_ns : target.scan_headers.front().time_ns;
  const SE3 target_from_world = first.at(start).value_or(first.poses().front().world_from_body).inverse();
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (i == 0 || shares_world(target, drives[i].drive))
      poses[i].world_from_lidar = poses[i].world_from_lidar.in(target_from_world);
  return poses;
}

Poses estimate_poses(const Recordings& drives, const job::Job& job, Progress& progress) {
  std::vector<PoseChoice> choices;
  for (const Recording& open : drives) {
    if (open.rig_of) continue;
    const bool is_target = choices.empty();
    choices.push_back(choose_poses(open.drive, is_target ? job.read.poses : job::PosesFrom(), job.options.odometry, progress));
  }
  Poses poses = transform_to_target_world(drives, std::move(choices));
  register_sources(drives, job, poses, progress);
  for (const Recording& open : drives)
    if (open.rig_of) poses.push_back(poses[*open.rig_of]);
  require_posed_frame(drives.front().drive, poses.front().world_from_lidar);
  return poses;
}

Poses use_given_poses(const Recordings& drives) {
  Poses poses;
  for (const Recording& open : drives) poses.push_back({{}, open.drive.poses});
  return poses;
}

}  // namespace dvi::inputs
