#include "dvi/inputs/find_masks.h"

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/text.h"
#include "dvi/core/threads.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/inputs/rig.h"
#include "dvi/objects/find_traffic.h"
#include "dvi/objects/motion.h"
#include "dvi/objects/past_border.h"

namespace dvi::inputs {
namespace {

constexpr std::int64_t kMaxFrameToScanNs = 100'000'000;

FrameLabels detected_in(const Recording& open, Progress& progress) {
  progress.begin("detect", open.drive.frames.size());
  FrameLabels labels = objects::find_objects(open.drive, *open.detector, [&] { progress.advance(); });
  progress.end();
  if (std::all_of(labels.begin(), labels.end(), [](const std::vector<Label>& frame) { return frame.empty(); }))
    progress.warn(open.drive.path.filename().string() + ": the detector sees nothing that is to be removed in any frame");
  return labels;
}

FrameLabels objects_of(const Recording& open, const Trajectory& world_from_lidar, const job::Job& job, Progress& progress) {
  const Drive& drive = open.drive;
  if (open.masks_from == objects::MaskSource::carried) return FrameLabels(drive.frames.size());
  if (open.masks_from == objects::MaskSource::detected) return detected_in(open, progress);
  FrameLabels labels =
      job.read.remove == job::Remove::moving ? objects::without_standing(drive, world_from_lidar) : drive.labels();
  return objects::continued_past_border(drive, std::move(labels), world_from_lidar, job.options.masks);
}

// For each scan, whether the check of the poses found that it is wrong.
std::vector<bool> untrusted_scans(const Drive& drive, const PoseChoice& choice) {
  std::vector<bool> untrusted(drive.scan_headers.size(), choice.misread && choice.from == PoseOrigin::given);
  if (choice.from == PoseOrigin::loam && choice.odometry)
    for (std::size_t i = 0; i < std::min(untrusted.size(), choice.odometry->scans.size()); ++i)
      untrusted[i] = choice.odometry->scans[i].state == odometry::ScanFit::State::lost;
  return untrusted;
}

void warn_of_untrusted(const Recording& open, const std::vector<bool>& untrusted, const std::vector<std::size_t>& contradictory,
                       Progress& progress) {
  const Drive& drive = open.drive;
  const auto warn = [&](const std::vector<std::size_t>& scans, const char* reason) {
    if (scans.empty()) return;
    std::set<int> frames;
    for (const std::size_t scan : scans)
      if (const Frame* frame = nearest_in_time(drive.frames, drive.scan_headers[scan].time_ns, kMaxFrameToScanNs))
        frames.insert(frame->number);
    progress.warn(fmt::format("{}: {} of {} scans {}, so no moving objects are looked for in them (frames {})", name_of(open),
                              scans.size(), drive.scan_headers.size(), reason,
                              frames.empty() ? "none" : format_ranges({frames.begin(), frames.end()})));
  };
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < untrusted.size(); ++i)
    if (untrusted[i]) known.push_back(i);
  warn(known, "have poses that are not to be trusted");
  warn(contradictory, "contradict the others in many places, as with wrong poses");
}

std::vector<objects::Track> tracks_in_scans(const Recording& open, const DrivePoses& poses, const job::Job& job,
                                            const ground::ScanGround* ground, Progress& progress) {
  if (ground == nullptr) return {};
  const Drive& drive = open.drive;
  progress.begin("traffic", drive.scan_headers.size());
  const std::vector<bool> untrusted = untrusted_scans(drive, poses.choice);
  const objects::FoundTraffic found = objects::find_traffic(
      drive, {poses.world_from_lidar, job.options.map.pose_error_m, untrusted}, *ground, [&] { progress.advance(); });
  progress.end();
  warn_of_untrusted(open, untrusted, found.contradictory, progress);
  return found.tracks;
}

std::vector<objects::Track> moving_in(const Recording& open, const DrivePoses& poses, const job::Job& job,
                                      const ground::ScanGround* ground, Progress& progress) {
  const std::vector<objects::Track> found = tracks_in_scans(open, poses, job, ground, progress);
  if (found.empty()) progress.warn(name_of(open) + ": nothing moves in it, as far as its scans tell: nothing is removed");
  return found;
}

// Of nothing but the ego mask.
Lazy<cv::Mat1b> always_masked(const Recording& open) {
  const Drive& drive = open.drive;
  const auto mask = open.ego_mask.empty() ? std::make_shared<const cv::Mat1b>(drive.camera.height, drive.camera.width, uchar{0})
                                          : std::make_shared<const cv::Mat1b>(open.ego_mask);
  return Lazy<cv::Mat1b>::through(drive.frames.size(), [mask](std::size_t) { return mask; });
}

Lazy<cv::Mat1b> with_ego(const Recording& open, const Lazy<cv::Mat1b>& masks) {
  if (open.ego_mask.empty()) return masks;
  return {masks.size(), [masks, ego = open.ego_mask](std::size_t i) { return cv::Mat1b(*masks[i] | ego); }};
}

// Masks without the ego mask, of what is removed because of masks or labels.
Lazy<cv::Mat1b> object_masks(const Recording& open, const SharedLabels& objects, const job::Job& job) {
  const Drive& drive = open.drive;
  const Lazy<cv::Mat1b> masks = objects::find_masks(drive, *open.masks_from, objects, job.options.masks);
  const bool labels_too =
      job.read.remove == job::Remove::all && open.masks_from == objects::MaskSource::files && drive.has_labels();
  if (!labels_too) return masks;
  const Lazy<cv::Mat1b> labeled = objects::find_masks(drive, objects::MaskSource::labels, objects, job.options.masks);
  return {labeled.size(), [masks, labeled](std::size_t i) { return cv::Mat1b(*masks[i] | *labeled[i]); }};
}

Lazy<cv::Mat1b> masks_of(const Recording& open, const SharedLabels& objects, const job::Job& job) {
  if (!open.masks_from) return always_masked(open);
  return with_ego(open, object_masks(open, objects, job));
}

// Whether masks or labels remove nothing in any frame. Most drives need a look at their first frame only.
bool removes_nothing(const Recording& open, const SharedLabels& objects, const job::Job& job) {
  const Lazy<cv::Mat1b> masks = object_masks(open, objects, job);
  for (std::size_t i = 0; i < masks.size(); ++i)
    if (cv::countNonZero(*masks[i]) > 0) return false;
  return true;
}

// Says what moves in the scans although masks or labels remove nothing.
std::string unmasked_motion(const Recording& open, const DrivePoses& poses, const job::Job& job,
                            const ground::ScanGround* ground, Progress& progress) {
  const Drive& drive = open.drive;
  const FrameLabels labels = objects::outlines(tracks_in_scans(open, poses, job, ground, progress), drive,
                                               poses.world_from_lidar, job.options.masks.footprint_margin_m);
  std::set<int> tracks;
  std::optional<int> first;
  for (std::size_t i = 0; i < labels.size(); ++i)
    for (const Label& label : labels[i]) {
      tracks.insert(label.track);
      if (!first) first = drive.frames[i].number;
    }
  if (!first) return {};
  return fmt::format(
      ", but its scans show {} object{} that move{}, the first in frame {}: give --masks found to remove what moves",
      tracks.size(), tracks.size() == 1 ? "" : "s", tracks.size() == 1 ? "s" : "", *first);
}

// `motion` says what moves nevertheless; it takes a look at all scans.
void warn_of_nothing_removed(const Recording& open, const SharedLabels& objects, const std::function<std::string()>& motion,
                             const job::Job& job, Progress& progress) {
  const bool from_labels = open.masks_from == objects::MaskSource::labels;
  if (open.rig_of || (!from_labels && open.masks_from != objects::MaskSource::files)) return;
  if (!removes_nothing(open, objects, job)) return;
  const Drive& drive = open.drive;
  std::size_t labels = 0;
  for (const Frame& frame : drive.frames) labels += frame.labels.size();
  const std::size_t files = static_cast<std::size_t>(
      std::count_if(drive.mask_files.begin(), drive.mask_files.end(), [](const fs::path& file) { return !file.empty(); }));
  const bool all_stationary = from_labels && labels > 0 && job.read.remove == job::Remove::moving;
  const std::string what = from_labels ? fmt::format("its labels ({} in {} frames) remove nothing{}", labels,
                                                     drive.frames.size(), all_stationary ? ": no labeled object moves" : "")
                                       : fmt::format("its {} mask files are empty and remove nothing", files);
  progress.warn(name_of(open) + ": " + what + motion());
}

// What labels of the drive's own camera do not draw in another one.
Lazy<cv::Mat1b> not_labeled(const Recording& own, FrameLabels objects, const Drive& other, const Trajectory& world_from_lidar,
                            const job::Job& job) {
  for (std::vector<Label>& frame : objects) std::erase_if(frame, [](const Label& label) { return label.box.has_value(); });
  return carried_masks(own.drive, masks_of(own, shared(std::move(objects)), job), other, world_from_lidar);
}

bool has_boxes_with_tracks(const Drive& drive) {
  return std::any_of(drive.frames.begin(), drive.frames.end(), [](const Frame& frame) {
    return std::any_of(frame.labels.begin(), frame.labels.end(), [](const Label& l) { return l.track >= 0 && l.box; });
  });
}

// --remove moving needs to know what stands.
void warn_of_all_removed(const Recording& open, const Trajectory& world_from_lidar, Progress& progress) {
  if (!open.masks_from || open.masks_from == objects::MaskSource::found) return;
  const Drive& drive = open.drive;
  const auto warn = [&](const char* reason, const char* remedy) {
    progress.warn(fmt::format("{}: --remove moving: {}, so everything masked is removed; {}", drive.path.filename().string(),
                              reason, remedy));
  };
  if (*open.masks_from == objects::MaskSource::detected)
    warn("a detector does not say what stands still",
         "leave it out of the masks that dvi mask writes, or use labels with 3D boxes");
  else if (*open.masks_from == objects::MaskSource::files)
    warn("mask files do not say what stands still", "leave out of them what is to stay, or use labels with 3D boxes");
  else if (world_from_lidar.empty())
    warn("without poses it is unknown what stands still", "give --poses FILE");
  else if (!has_boxes_with_tracks(drive))
    warn("no label has a 3D box and a track to tell what stands still", "give such labels with --masks FILE");
}

}  // namespace

Objects find_objects(const Recordings& drives, const Poses& poses, const Grounds& grounds, const job::Job& job,
                     Progress& progress) {
  Objects objects;
  std::map<std::size_t, std::vector<objects::Track>> moving;  // by drive: its cameras share them
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Recording& open = drives[i];
    const Trajectory& world_from_lidar = poses[i].world_from_lidar;
    if (job.read.remove == job::Remove::moving && !open.rig_of) warn_of_all_removed(open, world_from_lidar, progress);
    if (open.masks_from != objects::MaskSource::found) {
      objects.push_back(shared(objects_of(open, world_from_lidar, job, progress)));
      warn_of_nothing_removed(
          open, objects.back(), [&] { return unmasked_motion(open, poses[i], job, grounds.of(i).get(), progress); }, job,
          progress);
      continue;
    }
    const std::size_t drive = open.rig_of.value_or(i);
    const auto ground = grounds.of(i);
    if (drive == i) moving[i] = moving_in(open, poses[i], job, ground.get(), progress);
    SharedLabels seen =
        shared(objects::outlines(moving[drive], open.drive, world_from_lidar, job.options.masks.footprint_margin_m));
    if (ground)
      seen = shared(seen_in_images(open.drive, world_from_lidar, seen, moving[drive], masks_of(open, seen, job), ground));
    objects.push_back(seen);
  }
  return objects;
}

Masks find_masks(const Recordings& drives, const Poses& poses, const Grounds& grounds, const Objects& objects,
                 const job::Job& job, Progress& progress) {
  Masks masks;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Trajectory& world_from_lidar = poses[i].world_from_lidar;
    if (drives[i].masks_from == objects::MaskSource::carried) {
      const std::size_t own = *drives[i].rig_of;
      masks.push_back({carried_masks(drives[own].drive, masks[own].images, drives[i].drive, world_from_lidar), objects[i]});
      continue;
    }
    Lazy<cv::Mat1b> images = masks_of(drives[i], objects[i], job);
    if (const int radius = job.options.masks.file_dilation_px();
        radius > 0 && drives[i].masks_from == objects::MaskSource::files)
      progress.note(fmt::format("{}: its mask files are dilated by {} px (masks.dilate_px)", name_of(drives[i]), radius));
    const bool found = drives[i].masks_from == objects::MaskSource::found, shadows = job.options.masks.shadows;
    if (drives[i].masks_from && (found || shadows)) {
      const Compared what{found ? objects[i] : nullptr, shadows};
      images = compared(drives[i].drive, world_from_lidar, images, what, grounds.of(i), progress);
    }
    if (drives[i].labeled_in_part) {
      const std::size_t own = *drives[i].rig_of;
      const Lazy<cv::Mat1b> rest = not_labeled(drives[own], *objects[own], drives[i].drive, world_from_lidar, job);
      images = {images.size(), [images, rest](std::size_t frame) { return cv::Mat1b(*images[frame] | *rest[frame]); }};
    }
    masks.push_back({images, objects[i]});
  }
  return masks;
}

std::optional<StandingTracks> standing_tracks(const Recording& open, const Trajectory& world_from_lidar, const job::Job& job) {
  if (open.masks_from != objects::MaskSource::labels || job.read.remove == job::Remove::moving) return std::nullopt;
  const Drive& drive = open.drive;
  StandingTracks out{.standing = objects::standing_tracks(drive, world_from_lidar).size()};
  if (out.standing == 0) return std::nullopt;
  std::set<int> tracks;
  for (const Frame& frame : drive.frames)
    for (const Label& label : frame.labels)
      if (label.track >= 0) tracks.insert(label.track);
  out.tracks = tracks.size();
  const Lazy<cv::Mat1b> now = masks_of(open, shared(drive.labels()), job);
  const Lazy<cv::Mat1b> then = masks_of(open, shared(objects::without_standing(drive, world_from_lidar)), job);
  std::vector<std::size_t> pixels(now.size());
  parallel_for(pixels.size(),
               [&](std::size_t i) { pixels[i] = static_cast<std::size_t>(cv::countNonZero(cv::Mat1b(*now[i] & ~*then[i]))); });
  out.pixels = std::accumulate(pixels.begin(), pixels.end(), std::size_t{0});
  return out;
}

}  // namespace dvi::inputs
