#include "dvi/objects/labeled_objects.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <string>

#include "dvi/objects/draw_masks.h"
#include "dvi/objects/merge_labels.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/upper_edges.h"

namespace dvi::objects {
namespace {

// Sets source and class of the labels of tracks.
void describe_labels(std::span<const Track> tracks, FrameLabels& labels) {
  set_source(labels, MaskSource::points);
  std::vector<std::string> types;
  std::transform(tracks.begin(), tracks.end(), std::back_inserter(types), label_type);
  for (std::vector<Label>& frame : labels)
    for (Label& label : frame)
      if (const std::string& type = types[static_cast<std::size_t>(label.track)]; !type.empty()) label.type = type;
}

FrameLabels draw_tracks(std::span<const Track> tracks, const CameraEvidence& camera, const RemovalOptions& options) {
  FrameLabels labels = draw_outlines(tracks, camera.drive, camera.world_from_lidar, options.masks.footprint_margin_m);
  describe_labels(tracks, labels);
  return labels;
}

}  // namespace

std::vector<ObjectMotion> LabeledTracks::motions() const {
  const MotionState others = moving == 0 ? MotionState::unknown : MotionState::stationary;
  std::vector<ObjectMotion> out;
  for (std::size_t k = 0; k < tracks->size(); ++k)
    out.push_back({static_cast<int>(k), k < moving ? MotionState::moving : others});
  return out;
}

LabeledTracks find_labeled_tracks(const CameraRef& own, const RemovalOptions& options, Progress& progress) {
  const CameraEvidence& evidence = own.camera();
  const auto ground = own.ground();
  LabeledTracks out;
  if (!ground) {
    progress.warn(evidence.name + ": without poses, its labels of points remove nothing; give --poses FILE");
    return out;
  }
  const MovingReturns returns(evidence.drive, {evidence.world_from_lidar, options.pose_error_m, evidence.untrusted_scans},
                              *ground);
  progress.begin("labels", returns.scans());
  std::vector<Track> tracks = track_labeled(returns, progress.tick());
  progress.end();
  if (tracks.empty()) progress.warn(evidence.name + ": its labels of points show no object to remove");
  const auto others = std::stable_partition(tracks.begin(), tracks.end(), is_moving_labeled);
  out.moving = static_cast<std::size_t>(others - tracks.begin());
  find_upper_edges(evidence, returns, std::span(tracks).first(out.moving));
  out.tracks = share_tracks(std::move(tracks));
  return out;
}

FrameLabels draw_labeled_tracks(const CameraRef& ref, const LabeledTracks& objects, const RemovalOptions& options) {
  const CameraEvidence camera = ref.camera().restricted_to({MaskSource::points});
  const std::span<const Track> tracks = *objects.tracks, moving = tracks.first(objects.moving);
  FrameLabels labels = draw_tracks(moving, camera, options);
  if (!moving.empty()) {
    const SharedLabels outlines = shared(std::move(labels));
    labels = extend_in_images(ref, draw_plain_masks(camera, outlines, options), outlines, moving);
    describe_labels(moving, labels);
  }
  append(labels, draw_tracks(tracks.subspan(objects.moving), camera, options), static_cast<int>(objects.moving));
  return labels;
}

}  // namespace dvi::objects
