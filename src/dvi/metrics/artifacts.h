#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"

namespace dvi::metrics {

/// What draws the eye in a result, counted without a truth, in pixels. The ring is what lies within 40 px of a hole, outside of
/// masks: it shows what the scene itself does.
struct Artifacts {
  std::size_t hole = 0;          ///< of all frames
  std::size_t overshoots = 0;    ///< of the hole: darker or brighter than the ring, and unlike their neighbors
  std::size_t hole_between = 0;  ///< hole and ring of frames that have a frame before and behind them
  std::size_t ring_between = 0;
  std::size_t flashes = 0;  ///< of these: unlike both neighboring frames, which agree with each other
  std::size_t ring_flashes = 0;

  Artifacts& operator+=(const Artifacts& other);
  double flash_ppm() const;  ///< per million pixels; 0 of none
  double ring_flash_ppm() const;
  double overshoot_ppm() const;
};

/// Counts them in the frames/ and masks/ of a run. `names` in the order of the drive; ticks once a frame. `filled`: files of
/// other frames, by name, which count inside the masks instead.
Artifacts count_artifacts(
    const fs::path& out, const std::vector<std::string>& names, const Tick& tick = [] {},
    const std::function<fs::path(const std::string& name)>& filled = {});

}  // namespace dvi::metrics
