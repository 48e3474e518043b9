#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "dvi/result/cpu_clock.h"
#include "dvi/result/filled_view.h"
#include "dvi/smooth/smooth.h"

namespace dvi::run {

/// Stage 9: pairs a frame with the next, and smooths it between its pairs (null at the ends of the drive).
struct Smoothing {
  std::function<smooth::FramePair(const harmonize::FilledFrame& earlier, const harmonize::FilledFrame& later)> pair;
  std::function<harmonize::FilledFrame(const smooth::FramePair* before, const harmonize::FilledFrame& frame,
                                       const smooth::FramePair* after)>
      smooth;
};

/// What is done to single frames, each called from several threads.
struct FrameSteps {
  std::function<result::FilledView(std::size_t view)> fill;
  std::optional<Smoothing> smoothing;  ///< none: frames stay as filled
  std::function<void(std::size_t view, const result::FilledView& finished)> write;
};

/// Its CPU time booked; none where it is switched off.
std::optional<Smoothing> smoothing(const smooth::SmoothOptions& options, result::CpuClock& cpu);

/// Fills the given views of [0, count), ascending, in blocks of parallel work, together with the neighbors that smoothing
/// needs; smooths each between its neighbors and writes it. Each view is filled and each pair made once as long as it stays in
/// the window of a block.
void for_each_smoothed(const std::vector<std::size_t>& views, std::size_t count, const FrameSteps& steps);

}  // namespace dvi::run
