#include "dvi/pipeline/find_masks.h"

#include "dvi/masks/standing.h"

namespace dvi::pipeline {
namespace {

DriveMasks masks_of(const Recording& open, const Trajectory& world_from_lidar, const Job& job) {
  const Drive& drive = open.drive;
  if (!open.masks_from) {
    const auto nothing = std::make_shared<const cv::Mat1b>(drive.camera.height, drive.camera.width, uchar{0});
    return {Lazy<cv::Mat1b>::through(drive.frames.size(), [nothing](std::size_t) { return nothing; }), drive.labels()};
  }
  DriveMasks out;
  out.objects = job.read.remove == Remove::moving ? masks::without_standing(drive, world_from_lidar) : drive.labels();
  out.images = find_masks(drive, *open.masks_from, out.objects, job.options.masks);
  const bool labels_too = job.read.remove == Remove::all && open.masks_from == masks::MaskSource::files && drive.has_labels();
  if (!labels_too) return out;
  const Lazy<cv::Mat1b> labelled = find_masks(drive, masks::MaskSource::labels, out.objects, job.options.masks);
  out.images = {labelled.size(), [files = out.images, labelled](std::size_t i) { return cv::Mat1b(*files[i] | *labelled[i]); }};
  return out;
}

}  // namespace

Masks find_masks(const Recordings& drives, const Poses& poses, const Job& job) {
  Masks masks;
  for (std::size_t i = 0; i < drives.size(); ++i) masks.push_back(masks_of(drives[i], poses[i].world_from_lidar, job));
  return masks;
}

}  // namespace dvi::pipeline
