#pragma once

#include <memory>
#include <span>

#include "dvi/drive/label.h"
#include "dvi/geometry/trajectory.h"
#include "dvi/objects/background_comparison.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Returns the masks of views, enlarged to the positions that a track may have where no scan shows it well. The background
/// model must not contain pixels of the object, which hardly moves in the image if it is far ahead. Per view. The tracks must
/// outlive the masks.
Lazy<cv::Mat1b> mask_possible_positions(const Views& views, std::span<const Track> tracks,
                                        const std::shared_ptr<const ground::ScanGround>& ground);

/// Continues the outlines of tracks in the images, into frames between, before, and after those in which a scan shows the
/// object well. From frame to frame, an outline moves as the track does, corrected by the optical flow within it, as long as
/// the image differs from the background, or for a second if the background is unobserved. `labels` are per frame and have the
/// index of their track. Returns labels per frame; those of frames that no scan shows well are replaced.
FrameLabels track_in_images(const FrameLabels& labels, std::span<const Track> tracks, const BackgroundComparison& comparison,
                            const Trajectory& world_from_lidar);

}  // namespace dvi::objects
