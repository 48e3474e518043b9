#include "dvi/inputs/rig.h"

#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/inputs/mask_sources.h"
#include "dvi/labels/label_folder.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/media/image_file.h"
#include "dvi/objects/reprojected_mask.h"

namespace dvi::inputs {
namespace {

/// Returns the cameras of `--sources`; none for all cameras.
std::optional<std::set<std::string>> parse_source_cameras(const std::string& text) {
  if (text == "all" || text.empty()) return std::nullopt;
  std::set<std::string> names;
  if (text == "none") return names;
  for (const std::string& name : split_at_commas(text))
    if (!name.empty()) names.insert(name);
  return names;
}

void require_existing(const std::optional<std::set<std::string>>& asked, const Recordings& drives) {
  if (!asked) return;
  for (const std::string& name : *asked) {
    const auto has = [&](const Recording& open) {
      const auto& names = open.drive.camera_names;
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (std::none_of(drives.begin(), drives.end(), has))
      throw UsageError(
          fmt::format("--sources {}: there are all, none, {}", name, fmt::join(drives.front().drive.camera_names, ", ")));
  }
}

TimeSpan span_of(const Drive& drive) {
  return {drive.frames.front().time_ns - objects::kMaxRigGapNs, drive.frames.back().time_ns + objects::kMaxRigGapNs};
}

// Determined by the first image. If it is damaged, verify() reports it later.
bool is_gray(const Drive& drive) {
  if (datasets::holds_many_images(drive.frames.front().file)) {
    std::vector<cv::Mat> channels;
    cv::split(*drive.images[0], channels);
    return cv::norm(channels[0], channels[1], cv::NORM_INF) == 0 && cv::norm(channels[1], channels[2], cv::NORM_INF) == 0;
  }
  const cv::Mat picture = media::read_unchanged(drive.frames.front().file, cv::Size(drive.camera.width, drive.camera.height));
  if (picture.empty() || picture.channels() < 3) return !picture.empty();
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  return cv::norm(channels[0], channels[1], cv::NORM_INF) == 0 && cv::norm(channels[1], channels[2], cv::NORM_INF) == 0;
}

bool has_boxes(const Drive& drive) {
  return std::any_of(drive.frames.begin(), drive.frames.end(), [](const Frame& frame) {
    return std::any_of(frame.labels.begin(), frame.labels.end(), [](const Label& label) { return label.box.has_value(); });
  });
}

/// Attaches the mask files of another camera: its own, and those of folders with a subfolder for it. Returns whether there are
/// any.
bool attach_camera_masks(Drive& drive, const job::ReadChoice& choice) {
  using From = job::MasksFrom::Kind;
  bool and_own = choice.is_source && !drive.masks.empty();
  std::vector<job::MasksFrom> folders;
  if (!choice.is_source)
    for (const job::MasksFrom& from : choice.masks) {
      and_own |= (from.kind == From::automatic || from.kind == From::labels) && !drive.masks.empty();
      if (from.kind == From::path && labels::find_camera_folder(from.path, drive.camera_name)) folders.push_back(from);
    }
  attach_mask_files(drive, folders, and_own, choice);
  return and_own || !folders.empty();
}

/// Adds the labels of another camera in given folders that have a subfolder for it. Returns whether there are any.
bool attach_given_labels(Drive& drive, const job::ReadChoice& choice) {
  bool has_labels = false;
  if (choice.is_source) return has_labels;
  for (const job::MasksFrom& from : choice.masks)
    if (from.kind == job::MasksFrom::Kind::path) has_labels |= labels::attach_camera_labels(drive, from.path);
  return has_labels;
}

/// Chooses the mask sources of another camera, and attaches its mask files. They replace the sources of the drive's own camera
/// if that has one source only. Otherwise each source has its counterpart, or its masks are reprojected.
MaskSources choose_mask_sources(Drive& drive, const Recording& own, const job::ReadChoice& choice) {
  if (own.masks_from.empty()) return {};
  MaskSources out;
  if (attach_camera_masks(drive, choice)) {
    out.insert(MaskSource::files);
    if (own.masks_from.size() == 1) return out;
  }
  const bool boxes = own.drive.labeled_around || has_boxes(own.drive);
  for (const MaskSource source : own.masks_from)
    if (is_of_scans(source) || (source == MaskSource::labels && boxes))
      out.insert(source);
    else if (source != MaskSource::files || !out.contains(MaskSource::files))
      out.insert(MaskSource::reprojected);
  return out;
}

/// Copies the boxes of the frame nearest in time. Outlines are left out, because they belong to the other image.
void share_boxes(const Drive& from, Drive& to) {
  for (Frame& frame : to.frames) {
    frame.labels = nearest_in_time(from.frames.begin(), from.frames.end(), frame.time_ns)->labels;
    std::erase_if(frame.labels, [](const Label& label) { return !label.box; });
    for (Label& label : frame.labels) {
      label.rect.reset();
      label.instance.reset();
    }
  }
  to.labeled = true;
  to.labeled_around = from.labeled_around;
}

/// Reads a camera that is cleaned in all frames of the drive. Its images before the first or after the last one of the drive's
/// own camera are left out and named, because the objects at their times are not known.
Drive read_cleaned(const Drive& own, datasets::ReadOptions read) {
  Drive whole = datasets::read_drive(own.path, read);
  const TimeSpan span = span_of(own);
  if (whole.frames.front().time_ns >= span.first && whole.frames.back().time_ns <= span.last) return whole;
  read.span = span;
  Drive out = datasets::read_drive(own.path, read);
  out.warnings.push_back(
      fmt::format("{} of {} images of {} are not cleaned, because they are before the first or after the last image of {}",
                  whole.frames.size() - out.frames.size(), whole.frames.size(), out.camera_name, own.camera_name));
  return out;
}

/// Reads the images of a camera that were taken at the times of those of the drive's own camera.
Drive read_at_times(const Drive& own, datasets::ReadOptions read) {
  read.span = span_of(own);
  return datasets::read_drive(own.path, read);
}

/// A camera of a recording.
struct CameraToOpen {
  std::size_t drive = 0;  ///< index of the recording of the drive's own camera
  std::string name;
  bool is_cleaned = false;
};

Recording open_camera(const Recordings& drives, const CameraToOpen& asked, const job::ReadChoice& choice) {
  const auto& [number, camera, is_cleaned] = asked;
  const Recording& own = drives[number];
  datasets::ReadOptions read;
  read.camera = camera;
  read.topics = choice.topics;
  Recording open{is_cleaned && choice.frames.empty() ? read_cleaned(own.drive, read) : read_at_times(own.drive, read)};
  Drive& drive = open.drive;
  drive.scan_headers = own.drive.scan_headers;
  drive.scans = own.drive.scans;
  drive.map = own.drive.map;
  drive.poses = own.drive.poses;
  std::erase_if(drive.warnings, [&](const std::string& warning) {  // already reported for the own camera
    return std::find(own.drive.warnings.begin(), own.drive.warnings.end(), warning) != own.drive.warnings.end();
  });
  open.rig_of = number;
  open.is_cleaned = is_cleaned;
  const bool has_given_labels = !own.masks_from.empty() && attach_given_labels(drive, choice);
  open.masks_from = choose_mask_sources(drive, own, choice);
  if (is_cleaned && own.masks_from.contains(MaskSource::detected)) {
    open.detector = own.detector;
    open.masks_from.insert(MaskSource::detected);
    if (own.masks_from.size() == 1) open.masks_from.erase(MaskSource::reprojected);
  }
  if (has_given_labels) {
    open.masks_from.erase(MaskSource::reprojected);
    open.masks_from.insert(MaskSource::labels);
  }
  // A recording may label each camera's images at their own times. A label file given by the user is for the own camera only.
  const bool labeled = std::any_of(drive.frames.begin(), drive.frames.end(), [](const Frame& f) { return !f.labels.empty(); });
  const auto is_path = [](const job::MasksFrom& from) { return from.kind == job::MasksFrom::Kind::path; };
  const bool names_no_path = std::none_of(choice.masks.begin(), choice.masks.end(), is_path);
  const bool has_own_labels = has_given_labels || (labeled && drive.labeled_around && (choice.is_source || names_no_path));
  if (open.masks_from.contains(MaskSource::labels) && !has_own_labels) {
    share_boxes(own.drive, drive);
    open.labeled_in_part = !drive.labeled_around;
  }
  if (open.masks_from == MaskSources{MaskSource::files})
    if (const auto bare = labels::describe_frames_without_mask(drive)) drive.warnings.push_back(*bare);
  open.gray = is_gray(drive);
  return open;
}

/// Throws UsageError unless the drive has all cameras of a list.
void require_cameras(const std::string& cameras, const Drive& drive) {
  if (!job::has_other_cameras(cameras) || job::is_all_cameras(cameras)) return;
  for (const std::string& name : split_at_commas(cameras))
    if (!name.empty() && std::find(drive.camera_names.begin(), drive.camera_names.end(), name) == drive.camera_names.end())
      throw UsageError(fmt::format("--camera {}: the drive has {}", name, fmt::join(drive.camera_names, ", ")));
}

/// Cameras without colors cannot copy from those with colors, nor the other way around. They are cleaned in a run of their own.
void leave_gray_cameras(const std::string& cameras, Recordings& drives, Progress& progress) {
  for (Recording& open : drives) {
    if (!open.is_cleaned || open.gray == drives.front().gray) continue;
    const std::string& name = open.drive.camera_name;
    if (!job::is_all_cameras(cameras))
      throw UsageError(fmt::format(
          "--camera {}: cameras with and without colors are cleaned in runs of their own, such as --camera {}", cameras, name));
    open.is_cleaned = false;
    progress.warn(fmt::format("camera {} is not cleaned, because it has {}; clean it in a run of its own (--camera {})", name,
                              open.gray ? "no colors" : "colors", name));
  }
}

/// Moves the cleaned cameras to the front, and renumbers the drives of other cameras.
Recordings put_cleaned_first(Recordings drives) {
  std::vector<std::size_t> order;
  for (const bool cleaned : {true, false})
    for (std::size_t i = 0; i < drives.size(); ++i)
      if (drives[i].is_cleaned == cleaned) order.push_back(i);
  Recordings out;
  for (const std::size_t i : order) {
    out.push_back(std::move(drives[i]));
    if (std::optional<std::size_t>& own = out.back().rig_of)
      own = static_cast<std::size_t>(std::find(order.begin(), order.end(), *own) - order.begin());
  }
  return out;
}

}  // namespace

Recordings add_other_cameras(Recordings drives, const job::Job& job, Progress& progress) {
  const auto asked = parse_source_cameras(job.read.source_cameras);
  require_existing(asked, drives);
  require_cameras(job.read.camera, drives.front().drive);
  const std::size_t own = drives.size();
  for (std::size_t i = 0; i < own; ++i) {
    job::ReadChoice choice = job.read;
    choice.is_source = i > 0;
    for (const std::string& camera : std::vector<std::string>(drives[i].drive.camera_names)) {
      const bool is_cleaned = i == 0 && job::is_listed(camera, job.read.camera);
      if (camera == drives[i].drive.camera_name || (asked && !asked->contains(camera) && !is_cleaned)) continue;
      try {
        Recording open = open_camera(drives, {i, camera, is_cleaned}, choice);
        for (const std::string& warning : open.drive.warnings) progress.warn(name_of(open) + ": " + warning);
        drives.push_back(std::move(open));
      } catch (const InputError& e) {
        if (is_cleaned && !job::is_all_cameras(job.read.camera)) throw;
        progress.warn(
            fmt::format("camera {} is {}: {}", camera, is_cleaned ? "not cleaned" : "not used as a source", e.what()));
      }
    }
  }
  if (drives.size() > 1)
    for (std::size_t i = 0; i < own; ++i) drives[i].gray = is_gray(drives[i].drive);
  leave_gray_cameras(job.read.camera, drives, progress);
  std::stable_partition(drives.begin() + static_cast<std::ptrdiff_t>(own), drives.end(),
                        [](const Recording& open) { return !open.gray; });
  return put_cleaned_first(std::move(drives));
}

}  // namespace dvi::inputs
