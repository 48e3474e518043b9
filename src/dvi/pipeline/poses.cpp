#include "dvi/pipeline/poses.h"

#include <algorithm>
#include <utility>

#include "dvi/core/error.h"

namespace dvi::pipeline {
namespace {

// Given positions of another Mercator scale are brought to the target's.
Trajectory given_in_target_scale(const Drive& target, const Drive& drive) {
  const double scale = target.world_scale / drive.world_scale;
  std::vector<StampedPose> poses = drive.poses.poses();
  for (StampedPose& p : poses) p.world_from_body.t *= scale;
  return Trajectory(std::move(poses));
}

void require_poses(const Recordings& drives, const std::vector<PoseChoice>& choices) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Drive& drive = drives[i].drive;
    if (chosen(drive, choices[i]).empty() || (drive.poses.empty() && choices.size() > 1))
      throw InputError(drive.path, "has no poses",
                       "give --poses FILE (docs/formats.md says which files)" +
                           std::string(choices.size() > 1 ? "; drives can share a world by given poses only" : ""));
  }
}

void require_posed_frame(const Drive& drive, const Trajectory& world_from_lidar) {
  if (std::none_of(drive.frames.begin(), drive.frames.end(), [&](const Frame& f) { return world_from_lidar.at(f.time_ns); }))
    throw InputError(drive.path, "no frame has a pose", "check that poses and images share one clock");
}

}  // namespace

Poses in_one_world(const Recordings& drives, std::vector<PoseChoice> choices) {
  require_poses(drives, choices);
  const Drive& target = drives.front().drive;
  Poses poses;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const Trajectory given = given_in_target_scale(target, drives[i].drive);
    const bool loam = choices[i].from == PoseOrigin::loam;
    Trajectory trajectory = loam ? laid_onto(given, choices[i].odometry->world_from_lidar) : given;
    poses.push_back({std::move(choices[i]), std::move(trajectory)});
  }
  const Trajectory& first = poses.front().world_from_lidar;
  const std::int64_t start = target.scan_headers.empty() ? target.frames.front().time_ns : target.scan_headers.front().time_ns;
  const SE3 target_from_world = first.at(start).value_or(first.poses().front().world_from_body).inverse();
  for (DrivePoses& drive : poses) drive.world_from_lidar = drive.world_from_lidar.in(target_from_world);
  for (const Recording& open : drives)
    if (open.rig_of) poses.push_back(poses[*open.rig_of]);
  return poses;
}

Poses estimate_poses(const Recordings& drives, const Job& job, Progress& progress) {
  std::vector<PoseChoice> choices;
  for (const Recording& open : drives) {
    if (open.rig_of) continue;
    const bool is_target = choices.empty();
    choices.push_back(choose_poses(open.drive, is_target ? job.read.poses : PosesFrom(), job.options.odometry, progress));
  }
  Poses poses = in_one_world(drives, std::move(choices));
  require_posed_frame(drives.front().drive, poses.front().world_from_lidar);
  return poses;
}

Poses given_poses(const Recordings& drives) {
  Poses poses;
  for (const Recording& open : drives) poses.push_back({{}, open.drive.poses});
  return poses;
}

}  // namespace dvi::pipeline
