#include "dvi/pipeline/find_masks.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "dvi/masks/motion.h"
#include "dvi/traffic/find_traffic.h"
#include "dvi/traffic/shadows.h"

namespace dvi::pipeline {
namespace {

// The views of the frames that have a pose, masked as given; and of each frame the number of its view, or -1.
std::pair<Views, std::vector<int>> posed_views(const Drive& drive, const Trajectory& world_from_lidar,
                                               const Lazy<cv::Mat1b>& masks) {
  Views views;
  std::vector<int> view_of;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const std::int64_t time = drive.frames[i].time_ns;
    const auto pose = world_from_lidar.at(time);
    view_of.push_back(pose ? static_cast<int>(views.size()) : -1);
    if (pose) views.views.push_back({0, i, time, drive.camera, drive.camera_from_lidar * pose->inverse()});
  }
  const auto frame = [list = views.views](std::size_t i) { return list[i].frame; };
  views.images = Lazy<cv::Mat3b>::through(views.size(), [=, of = drive.images](std::size_t i) { return of[frame(i)]; });
  views.masks = Lazy<cv::Mat1b>::through(views.size(), [=](std::size_t i) { return masks[frame(i)]; });
  return {views, view_of};
}

Lazy<cv::Mat1b> with_shadows(const Drive& drive, const Trajectory& world_from_lidar, const Lazy<cv::Mat1b>& masks,
                             const std::shared_ptr<const traffic::Ground>& ground) {
  const auto [views, view_of] = posed_views(drive, world_from_lidar, masks);
  const Lazy<cv::Mat1b> shadowed = traffic::with_shadows(views, ground);
  return Lazy<cv::Mat1b>::through(drive.frames.size(), [=, view_of = view_of](std::size_t i) {
    return view_of[i] < 0 ? masks[i] : shadowed[static_cast<std::size_t>(view_of[i])];
  });
}

FrameLabels objects_of(const Recording& open, const Trajectory& world_from_lidar,
                       const std::shared_ptr<const traffic::Ground>& ground, const Job& job, Progress& progress) {
  const Drive& drive = open.drive;
  if (open.masks_from == masks::MaskSource::found) {
    progress.begin("traffic", drive.scan_headers.size());
    traffic::Traffic found =
        traffic::find_traffic(drive, world_from_lidar, *ground, job.options.map.pose_error_m, [&] { progress.advance(); });
    progress.end();
    return std::move(found.labels);
  }
  return job.read.remove == Remove::moving ? masks::without_standing(drive, world_from_lidar) : drive.labels();
}

DriveMasks masks_of(const Recording& open, const Trajectory& world_from_lidar, const Job& job, Progress& progress) {
  const Drive& drive = open.drive;
  if (!open.masks_from) {
    const auto nothing = std::make_shared<const cv::Mat1b>(drive.camera.height, drive.camera.width, uchar{0});
    return {Lazy<cv::Mat1b>::through(drive.frames.size(), [nothing](std::size_t) { return nothing; }), drive.labels()};
  }
  DriveMasks out;
  const bool shadows = job.options.masks.shadows && !world_from_lidar.empty() && !drive.scan_headers.empty();
  std::shared_ptr<const traffic::Ground> ground;
  if (shadows || open.masks_from == masks::MaskSource::found)
    ground = std::make_shared<const traffic::Ground>(drive, world_from_lidar);
  out.objects = objects_of(open, world_from_lidar, ground, job, progress);
  out.images = find_masks(drive, *open.masks_from, out.objects, job.options.masks);
  const bool labels_too = job.read.remove == Remove::all && open.masks_from == masks::MaskSource::files && drive.has_labels();
  if (labels_too) {
    const Lazy<cv::Mat1b> labelled = find_masks(drive, masks::MaskSource::labels, out.objects, job.options.masks);
    out.images = {labelled.size(),
                  [files = out.images, labelled](std::size_t i) { return cv::Mat1b(*files[i] | *labelled[i]); }};
  }
  if (shadows) out.images = with_shadows(drive, world_from_lidar, out.images, ground);
  return out;
}

bool has_boxes_with_tracks(const Drive& drive) {
  return std::any_of(drive.frames.begin(), drive.frames.end(), [](const Frame& frame) {
    return std::any_of(frame.labels.begin(), frame.labels.end(), [](const Label& l) { return l.track >= 0 && l.box; });
  });
}

// --remove moving needs to know what stands.
void warn_of_all_removed(const Recording& open, const Trajectory& world_from_lidar, Progress& progress) {
  if (!open.masks_from || open.masks_from == masks::MaskSource::found) return;
  const Drive& drive = open.drive;
  const auto warn = [&](const char* reason, const char* remedy) {
    progress.warn(fmt::format("{}: --remove moving: {}, so everything masked is removed; {}", drive.path.filename().string(),
                              reason, remedy));
  };
  if (*open.masks_from == masks::MaskSource::files)
    warn("mask files do not say what stands still", "leave out of them what is to stay, or use labels with 3D boxes");
  else if (world_from_lidar.empty())
    warn("without poses it is unknown what stands still", "give --poses FILE");
  else if (!has_boxes_with_tracks(drive))
    warn("no label has a 3D box and a track to tell what stands still", "give such labels with --masks FILE");
}

}  // namespace

Masks find_masks(const Recordings& drives, const Poses& poses, const Job& job, Progress& progress) {
  Masks masks;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (job.read.remove == Remove::moving) warn_of_all_removed(drives[i], poses[i].world_from_lidar, progress);
    masks.push_back(masks_of(drives[i], poses[i].world_from_lidar, job, progress));
  }
  return masks;
}

}  // namespace dvi::pipeline
