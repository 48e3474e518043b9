#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/diagnostics/flow_pairs.h"

namespace dvi::diagnostics {

/// Parameters of the check of the camera.
struct CameraCheckParams {
  std::size_t min_pairs = 5;         ///< fewer give no answer
  double max_cost = 0.6;             ///< a hypothesis with a larger cost does not explain the flow
  double max_relative_cost = 0.75;   ///< over the cost of the given camera; a hypothesis below is clearly better
  double min_sigmas = 3;             ///< standard errors by which an error differs from zero
  double min_agreement = 0.75;       ///< share of the pairs that must fit better, so that one with a truck does not decide
  double min_rotation_deg = 1;       ///< reported; alignment corrects smaller errors of the mounting
  double min_delay_s = 0.04;         ///< reported; smaller delays are within the range that is corrected
  double max_rotation_deg = 8;       ///< range of the search
  double rotation_step_deg = 2;      ///< of the search
  double max_delay_s = 1.2;          ///< range of the search
  double delay_step_s = 0.1;         ///< of the search
  double min_single_gain = 0.9;      ///< of the gain of rotation and clock together; then only one of them is wrong
  double min_visible_share = 0.002;  ///< share of a scan's returns within the image
  double max_center_ratio = 1.15;    ///< of the principal point and the center of the image, per axis
  double scale_step = 1.02;          ///< factor between the resolutions that are tried
};
inline constexpr CameraCheckParams kCameraCheck;

/// Checks the drive's camera (K, camera_from_lidar, clock) with the optical flow of pairs of images. Returns a warning with its
/// remedy for each contradiction; nothing if the camera is confirmed or the pairs do not suffice.
std::vector<std::string> check_camera(const FlowPairs& pairs, const SE3& camera_from_lidar);

}  // namespace dvi::diagnostics
