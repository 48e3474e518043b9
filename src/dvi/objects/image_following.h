#pragma once

#include <memory>
#include <vector>

#include "dvi/drive/label.h"
#include "dvi/geometry/trajectory.h"
#include "dvi/objects/comparison.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The masks of views, also where tracks may be that no scan shows well, generously: what is to be compared with the background
/// should not be compared with the object, which far ahead hardly moves in the image.
Lazy<cv::Mat1b> whereabouts(const Views& views, const std::vector<Track>& tracks,
                            const std::shared_ptr<const ground::ScanGround>& ground);

/// Labels of tracks (as the frames, by the number of the track), continued in the images: into frames between, before and after
/// those in which something near in time shows the object. From frame to frame its outline goes on as the track moves,
/// corrected by the optical flow within it, as long as the image there differs from what other times show, or for a second
/// where nobody else saw what is there. What labels say of these frames is replaced.
FrameLabels followed_in_images(const FrameLabels& labels, const std::vector<Track>& tracks, const Comparison& comparison,
                               const Trajectory& world_from_lidar);

}  // namespace dvi::objects
