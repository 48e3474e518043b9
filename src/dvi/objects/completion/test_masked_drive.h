#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/outline.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/objects/completion/complete.h"
#include "dvi/objects/completion/object_space.h"
#include "dvi/objects/motion_segmentation.h"

namespace dvi::objects {

// For tests only.

/// A drive with one camera and its masks or labels.
struct MaskedDrive {
  Drive drive;
  CameraEvidence evidence;
  Lazy<cv::Mat1b> masks;
  SharedLabels labels;
  ground::ScanGround ground;
  MovingReturns returns;

  MaskedDrive(Drive recorded, std::vector<cv::Mat1b> frame_masks, FrameLabels frame_labels = {})
      : drive(std::move(recorded)),
        evidence{drive, drive.poses, "drive", {MaskSource::files}},
        masks(make_masks(drive, std::move(frame_masks))),
        labels(make_labels(drive, std::move(frame_labels))),
        ground(drive, drive.poses),
        returns(drive, {drive.poses}, ground) {}
  MaskedDrive(const MaskedDrive&) = delete;
  MaskedDrive& operator=(const MaskedDrive&) = delete;

  std::vector<CameraMaskEvidence> cameras() const { return {{evidence, masks, masks, labels}}; }
  std::vector<OccupiedVoxel> find_space() const {
    return find_object_space(cameras(), returns, [] {});
  }

  /// Draws what completion adds to the masks, per frame.
  std::vector<cv::Mat1b> complete() {
    const SharedTracks tracks = share_tracks(segment_motion(returns, [] {}).tracks);
    const MaskOptions options;
    const CompletedObjects objects({cameras(), returns, ground, tracks, options}, [] {});
    std::vector<cv::Mat1b> out;
    const FrameLabels completed = objects.draw(cameras().front()).completed;
    for (const std::vector<Label>& frame : completed)
      out.push_back(draw_instances(frame, {drive.camera.width, drive.camera.height}));
    return out;
  }

 private:
  static Lazy<cv::Mat1b> make_masks(const Drive& drive, std::vector<cv::Mat1b> masks) {
    masks.resize(drive.frames.size());
    for (cv::Mat1b& mask : masks)
      if (mask.empty()) mask = cv::Mat1b(drive.camera.height, drive.camera.width, uchar{0});
    const std::size_t count = masks.size();
    return {count, count, [masks = std::move(masks)](std::size_t i) { return masks[i]; }};
  }
  static SharedLabels make_labels(const Drive& drive, FrameLabels labels) {
    labels.resize(drive.frames.size());
    return shared(std::move(labels));
  }
};

}  // namespace dvi::objects
