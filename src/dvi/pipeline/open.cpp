#include "dvi/pipeline/open.h"

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/io/labels.h"
#include "dvi/io/mask_folder.h"
#include "dvi/io/poses.h"
#include "dvi/masks/standing.h"

namespace dvi::pipeline {
namespace {

constexpr std::size_t kCached = 20;  // images and masks of all views together

masks::MaskSource resolve_masks(Drive& drive, const std::string& from) {
  if (from.empty() || from == "auto") return masks::default_mask_source(drive);
  if (from == "labels") return masks::MaskSource::labels;
  if (fs::is_directory(from)) {
    io::attach_masks(drive, from);
    return masks::MaskSource::files;
  }
  if (!fs::exists(from)) throw InputError(from, "does not exist", "--masks takes a folder, a file, labels or auto");
  const std::vector<std::vector<Label>> labels = io::read_labels(from, drive);
  for (std::size_t i = 0; i < labels.size(); ++i) drive.frames[i].labels = labels[i];
  drive.labelled = true;
  drive.other_files.emplace_back(from);
  return masks::MaskSource::labels;
}

Lazy<cv::Mat1b> masks_of(Drive& drive, const Source& source, MaskNeed need, const masks::MaskOptions& options) {
  const std::string& from = source.masks;
  const bool silent = drive.masks.empty() && !drive.has_labels() && (from.empty() || from == "auto");
  if (silent && need == MaskNeed::optional)
    return {drive.frames.size(), 1,
            [size = cv::Size(drive.camera.width, drive.camera.height)](std::size_t) { return cv::Mat1b(size, uchar{0}); }};
  const masks::MaskSource found = resolve_masks(drive, from);
  if (source.remove == "moving") masks::drop_standing(drive);
  const Lazy<cv::Mat1b> masks = masks::find_masks(drive, found, options);
  if (source.remove != "all" || found == masks::MaskSource::labels || !drive.has_labels()) return masks;
  const Lazy<cv::Mat1b> labelled = masks::find_masks(drive, masks::MaskSource::labels, options);
  return {masks.size(), 1, [masks, labelled](std::size_t i) { return cv::Mat1b(*masks[i] | *labelled[i]); }};
}

void resolve_poses(Drive& drive, const std::string& from) {
  if (from == "auto" || from == "given" || from == "loam") return;
  if (!fs::exists(from)) throw InputError(from, "does not exist", "--poses takes auto, given, loam or a file");
  drive.poses = io::read_poses(from, drive);
  drive.world_scale = 1;
  drive.other_files.emplace_back(from);
}

// The trajectory in the target's world. Positions of another Mercator scale are brought to the target's first.
Trajectory to_world_of(const Drive& target, const Drive& drive, const SE3& world_from_given) {
  const double scale = target.world_scale / drive.world_scale;
  std::vector<StampedPose> poses = drive.poses.poses();
  for (StampedPose& p : poses) p.world_from_body.t *= scale;
  return Trajectory(std::move(poses)).in(world_from_given);
}

// Images and masks of the views. The drives' own caches hold the pixels; these only look up the right one.
void attach_pictures(Views& views, const std::vector<OpenDrive>& drives) {
  const auto of = [list = views.views](std::size_t i) { return std::pair(list[i].drive, list[i].frame); };
  std::vector<Lazy<cv::Mat3b>> images;
  std::vector<Lazy<cv::Mat1b>> masks;
  for (const OpenDrive& open : drives) {
    images.push_back(open.drive.images);
    masks.push_back(open.masks);
  }
  views.images = {views.size(), kCached, [=](std::size_t i) { return *images[of(i).first][of(i).second]; }};
  views.masks = {views.size(), kCached, [=](std::size_t i) { return *masks[of(i).first][of(i).second]; }};
}

}  // namespace

OpenDrive open_drive(const fs::path& path, const Source& source, MaskNeed need, const masks::MaskOptions& options,
                     Progress& progress) {
  io::ReadOptions read;
  read.camera = source.camera;
  if (!source.frames.empty()) read.frames = parse_frames(source.frames);
  OpenDrive open{io::read_drive(path, read), {}, {}, {}};
  resolve_poses(open.drive, source.poses);
  open.masks = masks_of(open.drive, source, need, options);
  open.world_from_lidar = open.drive.poses;
  for (const std::string& warning : open.drive.warnings) progress.warn(path.filename().string() + ": " + warning);
  return open;
}

std::vector<OpenDrive> open_drives(const Job& job, MaskNeed need, Progress& progress) {
  std::vector<OpenDrive> drives;
  drives.push_back(open_drive(job.target, job.source, need, job.options.masks, progress));
  // Ranges and masks given by hand are the target's; a further drive is taken as it comes.
  Source further;
  further.camera = job.source.camera;
  further.remove = job.source.remove;
  for (const std::string& path : job.sources) drives.push_back(open_drive(path, further, need, job.options.masks, progress));
  return drives;
}

void find_poses(std::vector<OpenDrive>& drives, const Job& job, Progress& progress) {
  for (OpenDrive& open : drives) {
    const std::string wish = &open == &drives.front() ? job.source.poses : "auto";  // what is asked for is the target's
    open.poses = choose_poses(open.drive, wish, job.options.odometry, progress);
  }
  share_world(drives);
}

void share_world(std::vector<OpenDrive>& drives) {
  for (const OpenDrive& open : drives)
    if (chosen(open.drive, open.poses).empty() || (open.drive.poses.empty() && drives.size() > 1))
      throw InputError(open.drive.path, "has no poses",
                       "give --poses FILE (docs/formats.md says which files)" +
                           std::string(drives.size() > 1 ? "; drives can share a world by given poses only" : ""));
  const Drive& target = drives.front().drive;
  for (OpenDrive& open : drives) {
    const Trajectory given = to_world_of(target, open.drive, {});
    open.world_from_lidar = open.poses.from == "loam" ? laid_onto(given, open.poses.odometry->world_from_lidar) : given;
  }
  const Trajectory& first = drives.front().world_from_lidar;
  const std::int64_t start = target.sweeps.empty() ? target.frames.front().time_ns : target.sweeps.front().time_ns;
  const SE3 target_from_world = first.at(start).value_or(first.poses().front().world_from_body).inverse();
  for (OpenDrive& open : drives) open.world_from_lidar = open.world_from_lidar.in(target_from_world);
}

std::vector<OpenDrive> open_images(const Job& job, Progress& progress) {
  OpenDrive open = open_drive(job.target, job.source, MaskNeed::required, job.options.masks, progress);
  open.drive.sweeps.clear();
  open.drive.scans = {};
  if (!job.sources.empty()) progress.warn("method " + job.method + " has no use for further drives");
  return {open};
}

void verify(const std::vector<OpenDrive>& drives, Progress& progress) {
  std::size_t count = 0;
  for (const OpenDrive& open : drives) count += open.drive.frames.size() + open.drive.sweeps.size();
  progress.begin("read", count);
  for (const OpenDrive& open : drives) {
    const std::size_t frames = open.drive.frames.size();
    // The first error in order, whichever thread meets one first.
    std::vector<std::exception_ptr> errors(frames + open.drive.sweeps.size());
    parallel_for(errors.size(), [&](std::size_t i) {
      try {
        if (i < frames) {
          open.drive.images[i];
          open.masks[i];
        } else {
          open.drive.scans[i - frames];
        }
      } catch (...) {
        errors[i] = std::current_exception();
      }
      progress.advance();
    });
    for (const std::exception_ptr& error : errors)
      if (error) std::rethrow_exception(error);
  }
  progress.end();
}

void add_files(Fingerprint& print, const Drive& drive) {
  for (const Frame& frame : drive.frames) print.add_file(frame.file);
  for (const Sweep& sweep : drive.sweeps) print.add_file(sweep.file);
  for (const fs::path& file : drive.mask_files) print.add_file(file);
  for (const fs::path& file : drive.other_files) print.add_file(file);
}

std::vector<map::MapInput> map_inputs(const std::vector<OpenDrive>& drives) {
  std::vector<map::MapInput> inputs;
  for (const OpenDrive& open : drives) inputs.push_back({&open.drive, open.world_from_lidar, open.masks});
  return inputs;
}

Views make_views(const std::vector<OpenDrive>& drives, Progress& progress) {
  Views out;
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const Drive& drive = drives[d].drive;
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const std::int64_t time = drive.frames[i].time_ns;
      const std::optional<SE3> world_from_lidar = drives[d].world_from_lidar.at(time);
      if (!world_from_lidar) {
        progress.warn(
            fmt::format("{}: frame {} has no pose and is left out", drive.path.filename().string(), drive.frames[i].name));
        continue;
      }
      out.views.push_back({static_cast<int>(d), i, time, drive.camera, drive.camera_from_lidar * world_from_lidar->inverse()});
    }
  }
  if (out.of_drive(0).second == 0)
    throw InputError(drives.front().drive.path, "no frame has a pose", "check that poses and images share one clock");
  attach_pictures(out, drives);
  return out;
}

Views make_unposed_views(const std::vector<OpenDrive>& drives) {
  Views out;
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const Drive& drive = drives[d].drive;
    for (std::size_t i = 0; i < drive.frames.size(); ++i)
      out.views.push_back({static_cast<int>(d), i, drive.frames[i].time_ns, drive.camera, SE3()});
  }
  attach_pictures(out, drives);
  return out;
}

}  // namespace dvi::pipeline
