#include "dvi/objects/draw_masks.h"

#include <algorithm>
#include <memory>
#include <set>
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

// Draws the masks of mask files, labels, and detections, with their completion and shadows.
Lazy<cv::Mat1b> draw_shown(const CameraRef& ref, const CameraObjects& found, const RemovalOptions& options,
                           Progress& progress) {
  const CameraEvidence own = ref.camera().restricted_to({MaskSource::files, MaskSource::labels, MaskSource::detected});
  Lazy<cv::Mat1b> images = draw_plain_masks(own, found.labels, options);
  if (const int radius = options.masks.file_dilation_px(); radius > 0 && own.has(MaskSource::files))
    progress.note(fmt::format("{}: mask files are dilated by {} px (masks.dilate_px)", own.name, radius));
  if (has_labels(*found.completed) || has_labels(*found.background))
    images = {images.size(), [images, found, ego = own.ego_mask](std::size_t i) {
                const auto given = images[i];
                cv::Mat1b kept = draw_instances((*found.background)[i], given->size());
                if (!ego.empty()) kept.setTo(0, ego);
                return cv::Mat1b((*given & ~kept) | draw_instances((*found.completed)[i], given->size()));
              }};
  if (own.sources.empty() || !options.masks.shadows) return images;
  return refine_masks(ref, images, {nullptr, options.masks.shadows}, progress);
}

// Returns the labels of objects that the scans show, either those that move or the others.
FrameLabels select_scan_objects(const CameraObjects& found, bool moving) {
  std::set<int> numbers;
  for (const ObjectMotion& motion : found.motions)
    if (motion.state == MotionState::moving) numbers.insert(motion.object);
  FrameLabels out = *found.labels;
  for (std::vector<Label>& frame : out)
    std::erase_if(frame, [&](const Label& label) {
      const bool moves = label.source == MaskSource::found || numbers.contains(label.track);
      return !is_of_scans(label.source) || moves != moving;
    });
  return out;
}

// Draws the masks of objects that the scans show. Moving ones are refined in the images and have their shadows. Images do not
// show the background of stationary ones, for a comparison.
Lazy<cv::Mat1b> draw_scan_objects(const CameraRef& ref, const CameraObjects& found, const RemovalOptions& options,
                                  Progress& progress) {
  const CameraEvidence own = ref.camera().restricted_to({MaskSource::points, MaskSource::found});
  const Lazy<cv::Mat1b> images = refine_masks(ref, draw_plain_masks(own, shared(select_scan_objects(found, true)), options),
                                              {found.labels, options.masks.shadows}, progress);
  const SharedLabels stationary = shared(select_scan_objects(found, false));
  return has_labels(*stationary) ? unite(images, draw_object_masks(own, stationary, options)) : images;
}

// Draws the parts of a camera's images that the images of the drive's own camera do not show.
Lazy<cv::Mat1b> draw_outside(const Drive& own, const CameraEvidence& camera) {
  const cv::Size size(own.camera.width, own.camera.height);
  const Lazy<cv::Mat1b> nothing(own.frames.size(), [size](std::size_t) { return cv::Mat1b(size, uchar{0}); });
  return reproject_masks(own, nothing, camera.drive, camera.world_from_lidar);
}

Lazy<cv::Mat1b> subtract(const Lazy<cv::Mat1b>& masks, const Lazy<cv::Mat1b>& others) {
  return {masks.size(), [masks, others](std::size_t i) { return cv::Mat1b(*masks[i] & ~*others[i]); }};
}

// Draws the masks of a camera's own sources.
Lazy<cv::Mat1b> draw_camera(const CameraRef& ref, const Objects& objects, const RemovalOptions& options, Progress& progress) {
  const CameraEvidence& own = ref.camera();
  std::vector<Lazy<cv::Mat1b>> parts;
  if (own.shows_objects() || own.sources.empty()) parts.push_back(draw_shown(ref, objects[ref.index], options, progress));
  if (own.has(MaskSource::points) || own.has(MaskSource::found))
    parts.push_back(draw_scan_objects(ref, objects[ref.index], options, progress));
  Lazy<cv::Mat1b> images = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) images = unite(images, parts[i]);
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
  return draw_label_masks(evidence.drive, evidence.sources, objects, options.masks);
}

Lazy<cv::Mat1b> draw_plain_masks(const CameraEvidence& evidence, const SharedLabels& objects, const RemovalOptions& options) {
  if (evidence.sources.empty()) return draw_ego_masks(evidence);
  const Lazy<cv::Mat1b> masks = draw_object_masks(evidence, objects, options);
  if (evidence.ego_mask.empty()) return masks;
  return {masks.size(), [masks, ego = evidence.ego_mask](std::size_t i) { return cv::Mat1b(*masks[i] | ego); }};
}

Masks draw_masks(const Evidence& evidence, const Objects& objects, const RemovalOptions& options, Progress& progress) {
  Masks masks;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const CameraEvidence& camera = evidence[i];
    Lazy<cv::Mat1b> images, unknown;
    if (camera.sources != MaskSources{MaskSource::reprojected}) images = draw_camera({evidence, i}, objects, options, progress);
    if (camera.is_cleaned && (camera.labeled_in_part || camera.has(MaskSource::reprojected)))
      unknown = draw_outside(evidence[*camera.rig_of].drive, camera);
    const auto add_reprojected = [&](Lazy<cv::Mat1b> reprojected) {
      if (!unknown.empty()) reprojected = subtract(reprojected, unknown);
      images = images.empty() ? reprojected : unite(images, reprojected);
    };
    if (camera.labeled_in_part) {
      const std::size_t own = *camera.rig_of;
      add_reprojected(draw_unlabeled(evidence[own], *objects[own].labels, camera, options));
    }
    if (camera.has(MaskSource::reprojected)) {
      const std::size_t own = *camera.rig_of;
      add_reprojected(reproject_masks(evidence[own].drive, masks[own].images, camera.drive, camera.world_from_lidar));
    }
    masks.push_back({images, objects[i], unknown});
  }
  return masks;
}

Masks find_and_draw(const Evidence& evidence, const RemovalOptions& options, Progress& progress) {
  return draw_masks(evidence, find_objects(evidence, options, progress), options, progress);
}

GivenMasks draw_given_masks(const Evidence& evidence, const RemovalOptions& options) {
  GivenMasks out;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const CameraEvidence camera = evidence[i].restricted_to({MaskSource::files, MaskSource::labels});
    const Lazy<cv::Mat1b> images = camera.is_given()
                                       ? draw_plain_masks(camera, shared(select_given_labels(camera, options)), options)
                                       : draw_ego_masks(camera);
    out.masks.push_back({images});
  }
  const CameraEvidence& target = evidence[0];
  const bool is_exact = !options.masks.shadows && !options.objects.complete;
  out.complete = target.sources.empty() || (target.sources == MaskSources{MaskSource::files} && is_exact);
  out.refined = options.objects.complete && options.objects.refine;
  return out;
}

}  // namespace dvi::objects
