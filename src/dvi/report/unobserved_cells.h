#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/report/frame_pictures.h"

namespace dvi::report {

/// A square of the ground that pixels without any source show.
struct UnobservedCell {
  std::size_t frame = 0;  ///< the frame with most such pixels
  int pixels = 0;         ///< their number in that frame
};

/// The unobserved cells by position, in units of kUnobservedCellM.
using UnobservedCells = std::map<std::pair<int, int>, UnobservedCell>;
inline constexpr double kUnobservedCellM = 0.5;

/// Finds the positions of the pixels of a frame that no source observed (kinds 3 to 5). `above` is map/above.json, which has
/// the camera and the poses.
UnobservedCells find_unobserved_cells(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above);

/// Adds the cells of a frame to those of other frames.
void add(const UnobservedCells& frame, UnobservedCells& sum);

}  // namespace dvi::report
