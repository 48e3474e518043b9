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

// All that a case depends on.
std::string recipe_of(job::Job job, const holdout::HoldoutOptions& options, const inputs::Recordings& drives) {
  job.out.clear();
  Fingerprint print;
  print.add(kVersion);
  print.add(
      fmt::format("{} {} {} {}", holdout::name(options.scenario), options.seed, options.margin_px, options.ignore_margin_px));
  const std::set<std::string> used{"lidar", "masks", "odometry"};
  print.add(job.table().dump_toml([&](const Option& option) { return used.contains(option.section); }));
  for (const inputs::Recording& open : drives) print.add(open.drive.camera_name);
  print.add(job::to_string(job.read.masks) + " " + job::to_string(job.read.poses));
  print.add(to_string(job.read.mask_files.polarity) + " " + job.read.mask_files.classes + " " + job.read.ego_mask);
  for (const inputs::Recording& open : drives) inputs::add_files(print, open);
  return print.hex();
}

void make(const job::Job& job, const holdout::HoldoutOptions& options, bool keep, Progress& progress) {
  if (!keep) require_empty(job.out, "case");
  inputs::Recordings drives =
      inputs::add_other_cameras(inputs::open_recordings(job, inputs::MaskNeed::optional, progress), job, progress);
  // A colored vehicle in a gray picture would pass for a camera in color.
  std::erase_if(drives, [gray = drives.front().gray](const inputs::Recording& other) { return other.gray != gray; });
  const inputs::Recording& open = drives.front();
  if (!open.masks_from) progress.warn("the drive brings neither masks nor labels: its real traffic counts as street");
  const std::string recipe = recipe_of(job, options, drives);
  const std::string kept = keep ? holdout::holdout_recipe(job.out) : "";
  if (kept == recipe) return;
  if (!kept.empty())
    throw InputError(job.out, "holds a case made from another drive or with other options",
                     "remove it or choose another folder");
  const inputs::Poses poses = inputs::estimate_poses(drives, job, progress);
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  progress.begin(fmt::format("holdout {}", holdout::name(options.scenario)),
                 drives.size() * open.drive.frames.size() + open.drive.scan_headers.size());
  std::vector<holdout::HoldoutCamera> cameras;
  for (std::size_t i = 0; i < drives.size(); ++i) cameras.push_back({drives[i].drive, masks[i].images});
  Drive& drive = cameras.front().drive;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) drive.frames[i].labels = (*masks.front().objects)[i];
  const holdout::Holdout holdout(cameras, poses.front().world_from_lidar, options);
  holdout::write_holdout(holdout, job.out, recipe, progress.tick());
  progress.end();
  if (const auto stand = holdout.vehicle() ? holdout.vehicle()->stand() : std::nullopt; stand && stand->returns > 0)
    progress.warn(
        fmt::format("the {} vehicle of seed {} stands in what the scans show ({} returns inside it): no place within "
                    "15 m along the road is free; another --seed may find one",
                    holdout::name(options.scenario), options.seed, stand->returns));
}

}  // namespace

void make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress) {
  make(job, options, false, progress);
}

void keep_or_make_holdout(const job::Job& job, const holdout::HoldoutOptions& options, Progress& progress) {
  make(job, options, true, progress);
}

}  // namespace dvi::commands
