#include "dvi/commands/make_holdout.h"

#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/hash.h"
#include "dvi/core/version.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/rig.h"

namespace dvi::commands {
namespace {

/// Returns a fingerprint of everything that a case depends on.
std::string fingerprint_case(job::Job job, const holdout::HoldoutOptions& options, const inputs::Recordings& drives) {
  job.out.clear();
  Fingerprint print;
  print.add(kVersion);
  print.add(fmt::format("{} {} {} {} {}", holdout::name(options.scenario), options.seed, options.margin_px,
                        options.ignore_margin_px, to_string(options.mask_errors)));
  const std::set<std::string> used{"lidar", "masks", "odometry"};
  print.add(job.table().dump_toml([&](const Option& option) { return used.contains(option.section); }));
  for (const inputs::Recording& open : drives) print.add(open.drive.camera_name);
  print.add(job::to_string(job.read.masks) + " " + job::to_string(job.read.poses));
  print.add(to_string(job.read.mask_files.polarity) + " " + job.read.mask_files.classes + " " + job.read.ego_mask);
  for (const inputs::Recording& open : drives) inputs::add_files(print, open);
  return print.hex();
}

enum class ExistingCase { refuse, reuse };

void make_case(const job::Job& job, const holdout::HoldoutOptions& options, ExistingCase existing, Progress& progress) {
  if (existing == ExistingCase::refuse) require_empty(job.out, "case");
  job::require_one_camera(job.read.camera, "dvi holdout");
  inputs::Recordings drives =
      inputs::add_other_cameras(inputs::open_recordings(job, inputs::MaskNeed::optional, progress), job, progress);
  // A colored vehicle in a gray image would make the camera count as a color camera.
  std::erase_if(drives, [gray = drives.front().gray](const inputs::Recording& other) { return other.gray != gray; });
  const inputs::Recording& open = drives.front();
  if (open.masks_from.empty())
    progress.warn("the drive has neither masks nor labels, so its real traffic counts as background");
  const std::string recipe = fingerprint_case(job, options, drives);
  const std::string kept = existing == ExistingCase::reuse ? holdout::read_holdout_recipe(job.out) : "";
  if (kept == recipe) return;
  if (!kept.empty())
    throw InputError(job.out, "contains a case of another drive or with other options", "remove it or choose another folder");
  const inputs::Poses poses = inputs::estimate_poses(drives, job, progress);
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  progress.begin(fmt::format("holdout {}", holdout::name(options.scenario)),
                 drives.size() * open.drive.frames.size() + open.drive.scan_headers.size());
  std::vector<holdout::HoldoutCamera> cameras;
  for (std::size_t i = 0; i < drives.size(); ++i) cameras.push_back({drives[i].drive, masks[i].images});
  Drive& drive = cameras.front().drive;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) drive.frames[i].labels = (*masks.front().objects.labels)[i];
  const holdout::Holdout holdout(cameras, poses.front().world_from_lidar, options);
  holdout::write_holdout(holdout, job.out, recipe, progress.tick());
  progress.end();
  if (const auto position = holdout.vehicle() ? holdout.vehicle()->avoidance() : std::nullopt;
      position && position->returns > 0)
    progress.warn(
        fmt::format("the {} vehicle of seed {} overlaps with objects in the scans ({} returns are inside it), because no place "
                    "within 15 m along the road is free; try another --seed",
                    holdout::name(options.scenario), options.seed, position->returns));
}

}  // namespace

void make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress) {
  make_case(job, options, ExistingCase::refuse, progress);
}

void reuse_or_make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress) {
  make_case(job, options, ExistingCase::reuse, progress);
}

}  // namespace dvi::commands
