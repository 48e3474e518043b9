#pragma once

#include <span>
#include <string>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The moving objects of a drive.
struct MotionSegmentation {
  std::vector<Track> tracks;
  std::vector<std::size_t> contradictory_scans;  ///< scans with wrong poses (find_contradictory_scans()), which are not used
};

/// Finds moving objects without labels. Obstacle returns at positions where other scans observed free space are clustered and
/// tracked over time. Tracks are extended through the stationary phases before and after the motion. Scans with
/// wrong poses are excluded from further comparisons. Calls `tick` once per scan. Method:
/// docs/algorithms/motion_segmentation.md.
MotionSegmentation segment_motion(MovingReturns& returns, const Tick& tick);

/// Tracks the labeled returns of all scans (PointLabels), whether they move or not. Calls `tick` once per scan.
std::vector<Track> track_labeled(const MovingReturns& returns, const Tick& tick);

/// Returns whether most observations of a labeled track have a class of moving objects.
bool is_moving_labeled(const Track& track);

/// Returns the class of a labeled track for Label::type; empty if the labels do not state it.
std::string label_type(const Track& track);

/// Draws the outlines of tracks into the images of a drive, per frame. The track number of a label is the index in `tracks`.
/// `footprint_m` is the width of the ground around an object that belongs to it, with wheels and the darkest part of the
/// shadow.
FrameLabels draw_outlines(std::span<const Track> tracks, const Drive& drive, const Trajectory& world_from_lidar,
                          double footprint_m);

}  // namespace dvi::objects
