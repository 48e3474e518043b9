#include "dvi/pipeline/make_map.h"

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/pipeline/make_views.h"
#include "dvi/pipeline/map_files.h"
#include "dvi/pipeline/report_json.h"  // IWYU pragma: keep
#include "dvi/pipeline/result_folder.h"

namespace dvi::pipeline {
namespace {

// A map is in the world that the drive's own poses are given in.
SE3 world_from_map(const Drive& drive, const Trajectory& world_from_lidar) {
  if (drive.map.empty()) return {};
  const StampedPose& given = drive.poses.poses().front();
  return world_from_lidar.at(given.time_ns).value() * given.world_from_body.inverse();
}

}  // namespace

map::StaticMap build_map(const Recordings& drives, const Poses& poses, const Masks& masks, const map::MapOptions& options,
                         Progress& progress) {
  std::vector<map::MapInput> inputs;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Drive& drive = drives[i].drive;
    if (drives[i].rig_of)
      inputs[*drives[i].rig_of].more_cameras.push_back({&drive, masks[i].images});
    else
      inputs.push_back({&drive,
                        poses[i].world_from_lidar,
                        masks[i].images,
                        masks[i].objects,
                        {},
                        world_from_map(drive, poses[i].world_from_lidar)});
  }
  map::StaticMap map = build_map(inputs, options, progress.parts());
  if (map.points.empty()) progress.warn("the map is empty: no scan left a static point, nothing can be copied");
  return map;
}

std::string make_map(const Job& job, const std::string& trajectory, Progress& progress) {
  if (trajectory != "none" && trajectory != "kitti" && trajectory != "tum")
    throw UsageError("--trajectory " + trajectory + ": there are kitti and tum");
  require_apart(job);
  const Recordings drives = open_recordings(job, MaskNeed::optional, progress);
  verify(drives, job, progress);
  const Poses poses = estimate_poses(drives, job, progress);
  const Masks masks = find_masks(drives, poses, job, progress);
  const map::StaticMap map = build_map(drives, poses, masks, job.options.map, progress);
  const Views views = make_views(drives, poses, masks, progress);
  progress.begin("write", 0);
  const Drive& target = drives.front().drive;
  const fs::path out = job.out;
  write_map_files(out, map, views, target, tracks_of(*masks.front().objects, views, poses.front().world_from_lidar));
  if (trajectory != "none")
    write_trajectory(out / "trajectory.txt", target, poses.front().world_from_lidar, trajectory == "tum");
  progress.end();
  nlohmann::json report = map_report(map);
  report["poses"] = poses_report(target, poses.front().choice);
  report["cost"] = {{"stages", stages_json(progress.times(), "scan", map.scans.size())}, {"peak_memory_bytes", peak_memory()}};
  write_file(out / "map.json", json_text(report) + "\n");
  return json_text(report);
}

}  // namespace dvi::pipeline
