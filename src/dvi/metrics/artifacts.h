#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"

namespace dvi::metrics {

/// Parameters of the artifact counts.
struct ArtifactParams {
  int boundary_px = 40;          ///< width of the boundary
  int flow_margin_px = 64;       ///< around the boundary, where optical flow is computed
  int min_flash = 40;            ///< gray levels from both neighboring frames
  int max_neighbor_change = 20;  ///< gray levels between the neighboring frames
  double tail_share = 0.01;      ///< share of the boundary's pixels outside its range, at each end
  int range_margin = 5;          ///< gray levels beyond the range
  int median_px = 5;             ///< width of the median filter
  int min_outlier = 25;          ///< gray levels from the median
};
inline constexpr ArtifactParams kArtifact;

/// Visible artifacts of a result, counted in pixels without a truth. The boundary consists of the unmasked pixels within 40 px
/// of a hole; it shows how often the scene itself has such pixels.
struct Artifacts {
  std::size_t hole = 0;          ///< pixels of the holes of all frames
  std::size_t overshoots = 0;    ///< in holes: darker or brighter than the boundary, and different from their neighbors
  std::size_t hole_between = 0;  ///< pixels of holes and boundaries in frames between two others
  std::size_t ring_between = 0;
  std::size_t flashes = 0;  ///< of these: different from both neighboring frames, which agree with each other
  std::size_t ring_flashes = 0;

  Artifacts& operator+=(const Artifacts& other);
  double flash_ppm() const;  ///< per million pixels; 0 if there are none
  double ring_flash_ppm() const;
  double overshoot_ppm() const;
};

/// Counts the artifacts in frames/ and masks/ of a run. `names` are in the order of the drive. Calls `tick` once per frame. If
/// given, `filled` returns the file of another program's frame, which replaces the frame inside the masks.
Artifacts count_artifacts(
    const fs::path& out, const std::vector<std::string>& names, const Tick& tick = [] {},
    const std::function<fs::path(const std::string& name)>& filled = {});

}  // namespace dvi::metrics
