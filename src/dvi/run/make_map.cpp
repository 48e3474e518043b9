#include "dvi/run/make_map.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/process_memory.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/make_views.h"
#include "dvi/result/map_files.h"
#include "dvi/result/stage_json.h"
#include "dvi/result/usable_folder.h"

namespace dvi::run {
namespace {

/// Returns the pose of a given map, whose coordinates are those of the drive's given poses.
SE3 world_from_map(const Drive& drive, const Trajectory& world_from_lidar) {
  if (drive.map.empty()) return {};
  const StampedPose& given = drive.poses.poses().front();
  return world_from_lidar.at(given.time_ns).value() * given.world_from_body.inverse();
}

std::string format_share(std::size_t count, const map::MapCounts& counts) {
  return fmt::format("{:.1f} %",
                     100 * static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(counts.returns, 1)));
}

/// Throws InputError with the reasons why the map has no points, and the remedy for the most frequent reason. Most returns of a
/// LiDAR are outside of the camera's view in any case, so the view and the range are the main reason only if there is no other.
[[noreturn]] void refuse_empty_map(const Drive& target, const map::MapCounts& counts, const map::MapOptions& options) {
  struct Reason {
    std::size_t returns;
    std::string words;
    std::string remedy;
    bool usual = false;
  };
  constexpr double kMinShare = 0.01;
  const Reason reasons[] = {
      {counts.masked, "are covered by masks of removed objects",
       "check the masks: 255 = remove; --polarity black inverts them (dvi mask DRIVE -o MASKS writes "
       "contact.png)"},
      {counts.boxed, "are in labeled boxes", "check the labels: dvi check DRIVE"},
      {counts.unseen_by_camera, "were not observed by the camera while they were scanned",
       "check camera_from_lidar, and that images and scans share one clock (offset_s of the camera in dvi.toml)", true},
      {counts.too_near,
       fmt::format("are nearer than {:g} m or farther than {:g} m", options.min_range_m.value_or(target.min_range_m()),
                   options.max_range_m.value_or(target.max_range_m())),
       "set lidar.min_range_m and lidar.max_range_m to the range of the sensor in meters", true},
      {counts.moved, "are on the rays of other scans", "check the poses: --poses loam estimates them from the scans"}};
  std::string words;
  const Reason* most = nullptr;
  std::pair<bool, std::size_t> highest;
  std::size_t posed = 0;
  for (const Reason& reason : reasons) {
    posed += reason.returns;
    if (reason.returns == 0) continue;
    words += fmt::format(", {} {}", format_share(reason.returns, counts), reason.words);
    const bool is_rare = static_cast<double>(reason.returns) < kMinShare * static_cast<double>(counts.returns);
    const auto rank = std::pair(!reason.usual && !is_rare, reason.returns);
    if (most == nullptr || rank > highest) most = &reason, highest = rank;
  }
  if (counts.scans_without_pose > 0)
    words += fmt::format(", {} are of {} scans without a pose",
                         format_share(counts.returns - std::min(posed, counts.returns), counts), counts.scans_without_pose);
  throw InputError(target.path, fmt::format("no static points remain of {} returns{}", counts.returns, words),
                   most != nullptr                 ? most->remedy
                   : counts.scans_without_pose > 0 ? "check that poses and scans share one clock: dvi check DRIVE"
                                                   : "dvi check DRIVE shows the contents of the recording");
}

}  // namespace

map::StaticMap build_map(const inputs::Inputs& given, const map::MapOptions& options, Progress& progress) {
  const auto& [drives, poses, masks] = given;
  std::vector<map::MapInput> inputs;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Drive& drive = drives[i].drive;
    if (drives[i].rig_of)
      inputs[*drives[i].rig_of].more_cameras.push_back({&drive, masks[i].images});
    else
      inputs.push_back({&drive,
                        poses[i].world_from_lidar,
                        masks[i].images,
                        masks[i].objects.labels,
                        {},
                        world_from_map(drive, poses[i].world_from_lidar)});
  }
  map::StaticMap map = map::build_map(inputs, options, progress.parts());
  if (map.points.empty()) refuse_empty_map(drives.front().drive, map.counts, options);
  return map;
}

std::string make_map(const job::Job& job, std::optional<result::TrajectoryFormat> trajectory, Progress& progress) {
  result::require_apart(job);
  job::require_one_camera(job.read.camera, "dvi map");
  const inputs::Recordings drives = inputs::open_recordings(job, inputs::MaskNeed::optional, progress);
  inputs::verify(drives, job, progress);
  const inputs::Poses poses = inputs::estimate_poses(drives, job, progress);
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  const map::StaticMap map = build_map({drives, poses, masks}, job.options.map, progress);
  const Views views = inputs::make_views({drives, poses, masks}, progress);
  progress.begin("write", 0);
  const Drive& target = drives.front().drive;
  const fs::path out = job.out;
  result::write_map_files(
      out,
      {map, views, target, result::collect_object_paths(*masks.front().objects.labels, views, poses.front().world_from_lidar)});
  if (trajectory) result::write_trajectory(out / "trajectory.txt", target, poses.front().world_from_lidar, *trajectory);
  progress.end();
  nlohmann::json report = result::map_json(map);
  report["poses"] = result::poses_json(target, poses.front().choice);
  report["cost"] = {{"stages", result::stages_json(progress.times(), "scan", map.scans.size())},
                    {"peak_memory_bytes", peak_memory()}};
  write_file(out / "map.json", json_text(report) + "\n");
  return json_text(report);
}

}  // namespace dvi::run
