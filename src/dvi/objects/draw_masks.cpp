#include "dvi/objects/draw_masks.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"
#include "dvi/objects/image_masks.h"
#include "dvi/objects/motion.h"
#include "dvi/objects/past_border.h"
#include "dvi/objects/reprojected_mask.h"

namespace dvi::objects {
namespace {

// Draws masks that remove the ego mask only.
Lazy<cv::Mat1b> draw_ego_masks(const CameraEvidence& evidence) {
  const Drive& drive = evidence.drive;
  const auto mask = evidence.ego_mask.empty()
                        ? std::make_shared<const cv::Mat1b>(drive.camera.height, drive.camera.width, uchar{0})
                        : std::make_shared<const cv::Mat1b>(evidence.ego_mask);
  return Lazy<cv::Mat1b>::through(drive.frames.size(), [mask](std::size_t) { return mask; });
}

Lazy<cv::Mat1b> unite(const Lazy<cv::Mat1b>& a, const Lazy<cv::Mat1b>& b) {
  return {a.size(), [a, b](std::size_t i) { return cv::Mat1b(*a[i] | *b[i]); }};
}

bool has_labels(const FrameLabels& labels) {
  return std::any_of(labels.begin(), labels.end(), [](const std::vector<Label>& frame) { return !frame.empty(); });
}

// Draws the masks of objects in another camera that the labels of the drive's own camera do not outline there: objects without
// a box, and everything outside of its view.
Lazy<cv::Mat1b> draw_unlabeled(const CameraEvidence& own, const FrameLabels& objects, const CameraEvidence& other,
                               const RemovalOptions& options) {
  return reproject_masks(own.drive, draw_plain_masks(own, shared(select_unboxed(objects)), options), other.drive,
                         other.world_from_lidar);
}

Lazy<cv::Mat1b> draw_camera(const CameraRef& ref, const Objects& objects, const RemovalOptions& options, Progress& progress) {
  const CameraEvidence& own = ref.camera();
  Lazy<cv::Mat1b> images = draw_plain_masks(own, objects[ref.index].labels, options);
  if (const int radius = options.masks.file_dilation_px(); radius > 0 && own.source == MaskSource::files)
    progress.note(fmt::format("{}: mask files are dilated by {} px (masks.dilate_px)", own.name, radius));
  const CameraObjects& found = objects[ref.index];
  if (has_labels(*found.completed) || has_labels(*found.background))
    images = {images.size(), [images, found, ego = own.ego_mask](std::size_t i) {
                const auto given = images[i];
                cv::Mat1b kept = draw_instances((*found.background)[i], given->size());
                if (!ego.empty()) kept.setTo(0, ego);
                return cv::Mat1b((*given & ~kept) | draw_instances((*found.completed)[i], given->size()));
              }};
  const bool from_scans = own.source == MaskSource::found;
  if (own.source && (from_scans || options.masks.shadows))
    images = refine_masks(ref, images, {from_scans ? objects[ref.index].labels : nullptr, options.masks.shadows}, progress);
  if (own.labeled_in_part) {
    const std::size_t first = *own.rig_of;
    images = unite(images, draw_unlabeled(ref.evidence[first], *objects[first].labels, own, options));
  }
  return images;
}

// Returns the removed ones of a drive's labels, as they are given.
FrameLabels select_given_labels(const CameraEvidence& evidence, const RemovalOptions& options) {
  const Drive& drive = evidence.drive;
  return options.remove == Remove::moving ? remove_stationary(drive, evidence.world_from_lidar) : drive.labels();
}

}  // namespace

FrameLabels select_unboxed(FrameLabels labels) {
  for (std::vector<Label>& frame : labels) std::erase_if(frame, [](const Label& label) { return label.box.has_value(); });
  return labels;
}

FrameLabels select_removed_labels(const CameraEvidence& evidence, const RemovalOptions& options) {
  return extend_past_border(evidence.drive, select_given_labels(evidence, options), evidence.world_from_lidar, options.masks);
}

Lazy<cv::Mat1b> draw_object_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options) {
  const Drive& drive = evidence.drive;
  const Lazy<cv::Mat1b> masks = draw_label_masks(drive, *evidence.source, objects, options.masks);
  const bool add_labels = options.remove == Remove::all && evidence.source == MaskSource::files && drive.has_labels();
  return add_labels ? unite(masks, draw_label_masks(drive, MaskSource::labels, objects, options.masks)) : masks;
}

Lazy<cv::Mat1b> draw_plain_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options) {
  if (!evidence.source) return draw_ego_masks(evidence);
  const Lazy<cv::Mat1b> masks = draw_object_masks(evidence, objects, options);
  if (evidence.ego_mask.empty()) return masks;
  return {masks.size(), [masks, ego = evidence.ego_mask](std::size_t i) { return cv::Mat1b(*masks[i] | ego); }};
}

Masks draw_masks(const Evidence& evidence, const Objects& objects, const RemovalOptions& options, Progress& progress) {
  Masks masks;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const CameraEvidence& camera = evidence[i];
    if (camera.source == MaskSource::reprojected) {
      const std::size_t own = *camera.rig_of;
      masks.push_back(
          {reproject_masks(evidence[own].drive, masks[own].images, camera.drive, camera.world_from_lidar), objects[i]});
    } else {
      masks.push_back({draw_camera({evidence, i}, objects, options, progress), objects[i]});
    }
  }
  return masks;
}

Masks find_and_draw(const Evidence& evidence, const RemovalOptions& options, Progress& progress) {
  return draw_masks(evidence, find_objects(evidence, options, progress), options, progress);
}

GivenMasks draw_given_masks(const Evidence& evidence, const RemovalOptions& options) {
  GivenMasks out;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const CameraEvidence& camera = evidence[i];
    const Lazy<cv::Mat1b> images = camera.is_given()
                                       ? draw_plain_masks(camera, shared(select_given_labels(camera, options)), options)
                                       : draw_ego_masks(camera);
    out.masks.push_back({images});
  }
  const CameraEvidence& target = evidence[0];
  const bool is_exact = !options.masks.shadows && !options.objects.complete && options.remove != Remove::all;
  out.complete = !target.source || (target.source == MaskSource::files && is_exact);
  out.refined = options.objects.complete && options.objects.refine;
  return out;
}

}  // namespace dvi::objects
