#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Parameters of the check of labels. The core of a vehicle is the part of its box below the windows, above the openings
/// between the wheels, and away from beveled ends. Rays do not reach it if the box is right within about 10 cm.
struct LabelCheckParams {
  std::size_t max_frames = 12;
  std::int64_t max_scan_delay_ns = 60'000'000;  ///< between a frame and its scan
  double min_range_m = 3;                       ///< of a box
  double max_range_m = 40;                      ///< of a box
  double min_length_m = 2.5;                    ///< of a box; rays pass between the legs of people and the parts of bicycles
  double core_width = 0.7;                      ///< share of the box
  double core_bottom = 0.25;                    ///< share of the height
  double core_top = 0.55;                       ///< share of the height
  double box_tolerance_m = 0.2;                 ///< returns may be in front of a box by this
  std::size_t min_rays = 30;                    ///< that meet a box
  double min_passed_rays = 0.5;                 ///< share of rays through the core of a box that does not fit
  std::size_t min_boxes = 10;
  std::size_t min_frames = 3;
  double max_passed_boxes = 0.25;  ///< share of boxes; close to 0 for right labels, about 0.75 for labels of another drive
};
inline constexpr LabelCheckParams kLabelCheck;

/// Checks whether rays of the LiDAR pass through the core of labeled vehicles, as they do if the labels are of another drive.
/// Returns a warning, or nothing if the boxes stop the rays, or if they are too few or too far away.
std::vector<std::string> check_labels(const Drive& drive);

}  // namespace dvi::diagnostics
