#pragma once

#include <cstddef>

#include "dvi/align/align.h"
#include "dvi/align/unmasked_points.h"

namespace dvi::align {

/// Parameters of the joint refinement.
struct JointParams {
  double pair_error_px = 0.2;  ///< systematic error of a pair: errors of the map's surfaces, moving illumination
  double room_depth_m = 2;     ///< typical depth of a depth camera, at which pixels are converted to meters
  double min_slope = 0.01;     ///< change of the logarithm of brightness per pixel; less is not a texture
  double min_capture = 3;      ///< expected errors that the coarsest level must be able to correct
  double min_sigmas = 2;       ///< standard errors by which held-out points must agree better
  double max_offset_px = 0.6;  ///< median position error without a warning
  /// Path length over which a rotation common to all frames is observable. For handheld cameras, a position error of a
  /// centimeter has the effect of less than the expected 0.2 degrees only over 3 m.
  double min_path_m = 0.5;
  double min_handheld_path_m = 3;
  /// Largest distance in frames of compared views. A hand holds a view for seconds, with thirty images each; a vehicle does
  /// not.
  std::size_t max_frame_distance = 8;
  std::size_t max_handheld_frame_distance = 32;
  double radian_m = 10;              ///< distance in meters that counts as much as a radian between viewing directions
  std::size_t bytes_per_pixel = 40;  ///< memory of a view while its models are fitted, per pixel
};
inline constexpr JointParams kJoint;

/// Refines the poses of the views of one sequence jointly, relative to each other and to the nearest views of earlier
/// sequences, whose poses are in `out`. Fills the entries of the views and adds that of the sequence.
void align_jointly(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
