#include "dvi/inputs/recordings.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/core/text.h"
#include "dvi/core/threads.h"
#include "dvi/datasets/compare_times.h"
#include "dvi/datasets/pose_file.h"
#include "dvi/datasets/pose_jumps.h"
#include "dvi/image/interpolate.h"
#include "dvi/inputs/mask_sources.h"
#include "dvi/inputs/memory_plan.h"
#include "dvi/inputs/near_target.h"
#include "dvi/inputs/poses.h"
#include "dvi/labels/class_ids.h"
#include "dvi/labels/labels.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/labels/mask_reading.h"
#include "dvi/map/given_points.h"

namespace dvi::inputs {
namespace {

std::shared_ptr<const objects::Detector> load_detector(const job::ReadChoice& choice) {
  if (choice.detector.empty()) return nullptr;
  auto detector = std::make_shared<objects::Detector>(choice.detector);
  if (std::set<std::string, std::less<>> classes; !choice.mask_files.classes.empty()) {
    for (const std::string& name : split_at_commas(choice.mask_files.classes))
      if (!name.empty()) classes.insert(to_lower_case(name));
    detector->choose(classes);
  }
  return detector;
}

void resolve_poses(Drive& drive, const job::PosesFrom& from) {
  if (from.kind != job::PosesFrom::Kind::file) return;
  if (!fs::exists(from.file)) throw InputError(from.file, "does not exist", "--poses takes auto, given, loam or a file");
  drive.poses = datasets::read_poses(from.file, drive);
  datasets::leave_out_pose_jumps(drive);
  auto unposed = datasets::describe_unposed(drive);
  if (const auto clock = datasets::describe_pose_clock(drive)) *unposed += ": " + *clock;
  if (unposed &&
      std::none_of(drive.frames.begin(), drive.frames.end(), [&](const Frame& frame) { return drive.poses.at(frame.time_ns); }))
    throw InputError(from.file, *unposed, "poses and images must share one clock");
  if (unposed) drive.warnings.push_back(*unposed);
  drive.world_scale = 1;
  drive.other_files.emplace_back(from.file);
}

/// The distances from the sensor between which returns are used.
struct RangeLimits {
  double min_m, max_m;
};

RangeLimits range_limits(const Drive& drive, const map::MapOptions& options) {
  return {options.min_range_m.value_or(drive.min_range_m()), options.max_range_m.value_or(drive.max_range_m())};
}

struct ReturnCounts {
  std::size_t all = 0, near = 0, far = 0;  ///< near and far: below and above the limits
};

ReturnCounts count_returns(const Scan& scan, const RangeLimits& range) {
  ReturnCounts out{.all = scan.size()};
  for (const Eigen::Vector3f& point : scan.points) {
    if (point.norm() < range.min_m) ++out.near;
    if (point.norm() > range.max_m) ++out.far;
  }
  return out;
}

std::optional<std::string> describe_unused_returns(const std::vector<ReturnCounts>& scans, const RangeLimits& range) {
  constexpr double kMaxUnusedShare = 0.1;
  ReturnCounts sum;
  for (const ReturnCounts& scan : scans) sum.all += scan.all, sum.near += scan.near, sum.far += scan.far;
  const double all = static_cast<double>(sum.all), near = static_cast<double>(sum.near), far = static_cast<double>(sum.far);
  if (near + far <= kMaxUnusedShare * all) return std::nullopt;
  return fmt::format(
      "{:.0f} % of all returns are not used: {:.0f} % are nearer than lidar.min_range_m = {:g}, {:.0f} % farther than "
      "lidar.max_range_m = {:g}; set these to the range of the sensor, such as --set lidar.min_range_m=0.1",
      100 * (near + far) / all, 100 * near / all, range.min_m, 100 * far / all, range.max_m);
}

/// Every revolution of a LiDAR has about as many returns as the others, unless its file is truncated.
std::optional<std::string> describe_truncated_scans(const Drive& drive, const std::vector<ReturnCounts>& scans) {
  constexpr double kMinCountShare = 0.1;  // relative to the median
  if (drive.sensor != Sensor::lidar) return std::nullopt;
  std::vector<double> counts;
  for (const ReturnCounts& scan : scans) counts.push_back(static_cast<double>(scan.all));
  const double median_count = median(counts);
  const auto is_truncated = [&](double count) { return count < kMinCountShare * median_count; };
  const auto first = std::find_if(counts.begin(), counts.end(), is_truncated);
  if (first == counts.end()) return std::nullopt;
  return fmt::format(
      "{} of {} scans have less than a tenth of the median of {:.0f} returns; the first is {} with {:.0f}: its file may be "
      "truncated",
      std::count_if(counts.begin(), counts.end(), is_truncated), counts.size(), median_count,
      drive.scan_headers[static_cast<std::size_t>(first - counts.begin())].name, *first);
}

bool is_same_camera(const Drive& a, const Drive& b) {
  return a.camera_name == b.camera_name && a.camera.width == b.camera.width && a.camera.height == b.camera.height;
}

/// Reads the part of a source drive that is near the target by given poses; all of it if poses are missing.
Drive read_near_target(const Drive& target, const fs::path& path, datasets::ReadOptions read, Progress& progress) {
  Drive whole = datasets::read_drive(path, read);
  if (!shares_world(target, whole)) return whole;
  read.span = time_near_target(target, whole);
  if (!read.span) return whole;  // register_sources() refuses it
  const auto is_near = [&](const Frame& frame) {
    return frame.time_ns >= read.span->first && frame.time_ns <= read.span->last;
  };
  const auto near = static_cast<std::size_t>(std::count_if(whole.frames.begin(), whole.frames.end(), is_near));
  if (near == 0 || near == whole.frames.size()) return whole;
  progress.note(fmt::format("{}: {} of {} frames are near {} by the given poses; the other frames are not read",
                            path.filename().string(), near, whole.frames.size(), target.path.filename().string()));
  return datasets::read_drive(path, read);
}

/// Returns whether `--masks none` excludes all sources beside the detector.
bool uses_nothing_but_detector(const job::ReadChoice& choice) {
  return std::all_of(choice.masks.begin(), choice.masks.end(),
                     [](const job::MasksFrom& from) { return from.kind == job::MasksFrom::Kind::none; });
}

/// The options with which a drive is opened.
struct OpenOptions {
  const job::ReadChoice& choice;
  std::shared_ptr<const objects::Detector> detector;
  MaskNeed need;
  const Drive* target = nullptr;  ///< of a source drive
};

Recording open_drive(const fs::path& path, const OpenOptions& options, Progress& progress) {
  const auto& [choice, detector, need, target] = options;
  datasets::ReadOptions read;
  read.camera = job::first_camera(choice.camera);
  read.topics = choice.topics;
  if (!choice.frames.empty()) read.frames = job::parse_frames(choice.frames);
  Recording open{target != nullptr ? read_near_target(*target, path, read, progress) : datasets::read_drive(path, read), {}};
  if (read.frames && read.frames->first == read.frames->last)
    progress.note(fmt::format("frame {} only (--frames A:B for a range): nothing is copied from the drive's other frames",
                              read.frames->first));
  Drive& drive = open.drive;
  std::size_t warned = 0;
  const auto warn = [&] {
    for (; warned < drive.warnings.size(); ++warned)
      progress.warn(drive.path.filename().string() + ": " + drive.warnings[warned]);
  };
  warn();  // these may explain an error below
  resolve_poses(drive, choice.poses);
  open.detector = detector;
  if (detector)
    for (const fs::path& file : detector->files()) drive.other_files.push_back(file);
  open.masks_from = attach_mask_sources(drive, choice, need);
  if (!choice.ego_mask.empty()) open.ego_mask = labels::read_static_mask(drive, choice.ego_mask, choice.mask_files.polarity);
  if (open.masks_from == MaskSources{MaskSource::files})
    if (const auto bare = labels::describe_frames_without_mask(drive)) drive.warnings.push_back(*bare);
  warn();
  return open;
}

}  // namespace

std::string name_of(const Recording& open) {
  return open.drive.path.filename().string() + (open.rig_of ? " " + open.drive.camera_name : "");
}

std::string mask_source(const Recording& open) { return to_string(open.masks_from); }

Recording open_recording(const fs::path& path, const job::ReadChoice& choice, MaskNeed need, Progress& progress) {
  return open_drive(path, {choice, load_detector(choice), need}, progress);
}

Recordings open_recordings(const job::Job& job, MaskNeed need, Progress& progress) {
  bound_memory(job.memory_mb, {});
  Recordings drives;
  const std::shared_ptr<const objects::Detector> detector = load_detector(job.read);
  drives.push_back(open_drive(job.target, {job.read, detector, need}, progress));
  drives.front().is_cleaned = true;
  job::ReadChoice further;
  further.camera = job::first_camera(job.read.camera);
  further.topics = job.read.topics;
  further.mask_files = job.read.mask_files;
  further.detector = job.read.detector;
  further.remove = job.read.remove;
  if (uses_nothing_but_detector(job.read)) further.masks = job.read.masks;
  further.is_source = true;
  const MaskNeed of_sources = need == MaskNeed::required ? MaskNeed::wanted : need;
  for (const std::string& path : job.sources)
    drives.push_back(open_drive(path, {further, detector, of_sources, &drives.front().drive}, progress));
  for (Recording& open : drives)
    if (is_same_camera(open.drive, drives.front().drive)) open.ego_mask = drives.front().ego_mask;
  if (const auto warning = bound_memory(job, drives)) progress.warn(*warning);
  return drives;
}

Recordings open_images(const job::Job& job, Progress& progress) {
  bound_memory(job.memory_mb, {});
  Recording open = open_recording(job.target, job.read, MaskNeed::required, progress);
  open.masks_from = without_scans(std::move(open.masks_from));
  if (open.masks_from.empty())
    throw InputError(open.drive.path, "has neither masks nor labels, and method " + to_string(job.method) + " finds none",
                     "make some with dvi mask, and give --masks DIR");
  open.drive.scan_headers.clear();
  open.drive.scans = {};
  open.drive.point_labels = {};
  if (!job.sources.empty()) progress.warn("method " + to_string(job.method) + " does not use source drives");
  if (const auto warning = bound_memory(job, {open})) progress.warn(*warning);
  return {open};
}

std::optional<std::string> bound_memory(const job::Job& job, const Recordings& drives) {
  cv::Size largest;
  for (const Recording& open : drives)
    if (const cv::Size size(open.drive.camera.width, open.drive.camera.height); size.area() > largest.area()) largest = size;
  return bound_memory(job.memory_mb, largest);
}

namespace {

/// Requires that the drive's own map, if any, has points near its path.
void verify_map(const Drive& drive, const map::MapOptions& options) {
  if (drive.map.empty()) return;
  if (drive.poses.empty())
    throw InputError(drive.path, "has a map but no poses in it", "give poses.txt, or --poses FILE (docs/formats.md)");
  const map::GivenCoverage reach = map::measure_given_coverage(drive, options);
  if (reach.near == 0)
    throw InputError(drive.map_file,
                     fmt::format("none of its {} points is near the path; the nearest is {:.0f} m from its first pose",
                                 reach.points, reach.nearest_m),
                     "poses and map must share one world");
}

}  // namespace

std::vector<std::string> verify(const Recordings& drives, const job::Job& job, Progress& progress) {
  std::size_t count = 0;
  const auto scans_of = [](const Recording& open) { return open.rig_of ? 0 : open.drive.scan_headers.size(); };
  for (const Recording& open : drives) count += open.drive.frames.size() + scans_of(open);
  progress.begin("read", count);
  std::vector<std::string> warnings;
  for (const Recording& open : drives) {
    if (!open.rig_of) verify_map(open.drive, job.options.map);
    const std::size_t frames = open.drive.frames.size();
    const RangeLimits range = range_limits(open.drive, job.options.map);
    // The first error in the order of the files is reported, independent of the order of the threads.
    std::vector<std::exception_ptr> errors(frames + scans_of(open));
    std::vector<ReturnCounts> returns(scans_of(open));
    parallel_for(errors.size(), [&](std::size_t i) {
      try {
        if (i < frames) {
          open.drive.images[i];
          if (open.masks_from.contains(MaskSource::files)) open.drive.masks[i];
        } else {
          returns[i - frames] = count_returns(*open.drive.scans[i - frames], range);
          if (!open.drive.point_labels.empty()) open.drive.point_labels[i - frames];
        }
      } catch (...) {
        errors[i] = std::current_exception();
      }
      progress.advance();
    });
    for (const std::exception_ptr& error : errors)
      if (error) std::rethrow_exception(error);
    for (const std::optional<std::string>& warning :
         {describe_unused_returns(returns, range), describe_truncated_scans(open.drive, returns)})
      if (warning) warnings.push_back(name_of(open) + ": " + *warning);
  }
  progress.end();
  for (const std::string& warning : warnings) progress.warn(warning);
  return warnings;
}

void require_provenance_range(const Recordings& drives) {
  constexpr int kMostSidePx = (std::numeric_limits<std::uint16_t>::max() + 1) / static_cast<int>(kSubpixel);
  for (const Recording& open : drives)
    if (const Camera& camera = open.drive.camera; std::max(camera.width, camera.height) > kMostSidePx)
      throw InputError(open.drive.path,
                       fmt::format("the images of camera {} have {}x{} pixels; at most {} per side can be recorded as the "
                                   "positions of sources",
                                   open.drive.camera_name, camera.width, camera.height, kMostSidePx),
                       "reduce the images and the calibration");
  constexpr std::size_t kMost = std::numeric_limits<std::uint16_t>::max() - 1;
  std::size_t images = 0;
  for (const Recording& open : drives) images += open.drive.frames.size();
  if (images > kMost)
    throw InputError(
        drives.front().drive.path,
        fmt::format("has {} images with those of its other cameras and source drives; at most {} can be numbered as "
                    "sources",
                    images, kMost),
        "limit the frames (--frames A:B) or the cameras (--sources NAME,NAME or none)");
}

std::vector<fs::path> files_of(const Recording& open) {
  const Drive& drive = open.drive;
  std::vector<fs::path> files;
  for (const Frame& frame : drive.frames) files.push_back(frame.file);
  if (!open.rig_of)
    for (const ScanHeader& header : drive.scan_headers) files.push_back(header.file);
  files.insert(files.end(), drive.mask_files.begin(), drive.mask_files.end());
  files.insert(files.end(), drive.other_files.begin(), drive.other_files.end());
  // A bag or a video is the file of many frames.
  if (datasets::holds_many_images(drive.frames.front().file)) {
    std::set<fs::path> known;
    std::erase_if(files, [&](const fs::path& file) { return !file.empty() && !known.insert(file).second; });
  }
  return files;
}

void add_files(Fingerprint& print, const Recording& open) {
  const Drive& drive = open.drive;
  const std::vector<fs::path> files = files_of(open);
  std::vector<std::string> hashes(files.size());
  parallel_for(files.size(), [&](std::size_t i) {
    const bool large = datasets::holds_many_images(files[i]);
    if (files[i].empty()) return;  // a frame without a mask
    hashes[i] = large ? compute_file_hash(files[i]) : compute_file_hash(files[i], kMaxFileBytes);
  });
  print.add(drive.path.filename().string());  // cached warnings contain it
  if (open.detector) print.add(open.detector->engine());
  print.add(fmt::format("{} {} {}", drive.frames.size(), drive.scan_headers.size(), drive.mask_files.size()));
  for (std::size_t i = 0; i < files.size(); ++i) {
    print.add(files[i].filename().string());
    print.add(hashes[i]);
  }
}

}  // namespace dvi::inputs
