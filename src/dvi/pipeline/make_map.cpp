#include "dvi/pipeline/make_map.h"

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/pipeline/map_files.h"
#include "dvi/pipeline/report.h"

namespace dvi::pipeline {

map::StaticMap map_drives(const std::vector<OpenDrive>& drives, const map::MapOptions& options, Progress& progress) {
  const std::vector<map::MapInput> inputs = map_inputs(drives);
  map::StaticMap map = map::build_map(inputs, options, progress.parts());
  if (map.points.empty()) progress.warn("the map is empty: no scan left a static point, nothing can be copied");
  return map;
}

std::string make_map(const Job& job, const std::string& trajectory, Progress& progress) {
  if (trajectory != "none" && trajectory != "kitti" && trajectory != "tum")
    throw UsageError("--trajectory " + trajectory + ": there are kitti and tum");
  std::vector<OpenDrive> drives = open_drives(job, MaskNeed::optional, progress);
  find_poses(drives, job, progress);
  verify(drives, progress);
  const map::StaticMap map = map_drives(drives, job.options.map, progress);
  const Views views = make_views(drives, progress);
  progress.begin("write", 0);
  const OpenDrive& target = drives.front();
  const fs::path out = job.out;
  write_map_files(out, map, views, target.drive);
  if (trajectory != "none")
    write_trajectory(out / "trajectory.txt", target.drive, target.world_from_lidar, trajectory == "tum");
  progress.end();
  nlohmann::json report = map_report(map);
  report["poses"] = poses_report(target.drive, target.poses);
  report["cost"] = {{"stages", stages_report(progress, "scan", map.sweeps.size())}, {"peak_memory_bytes", peak_memory()}};
  write_file(out / "map.json", report.dump(1) + "\n");
  return report.dump(1);
}

}  // namespace dvi::pipeline
