#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "dvi/drive/view.h"
#include "dvi/result/cpu_clock.h"
#include "dvi/result/filled_view.h"
#include "dvi/smooth/smooth.h"

namespace dvi::run {

/// Temporal smoothing (section 3.6 of the paper): `pair` computes the flow between a frame and the next, `smooth` averages a
/// frame with its neighbors; a pair is null at the ends of the drive.
struct Smoothing {
  std::function<smooth::FramePair(const harmonize::FilledFrame& earlier, const harmonize::FilledFrame& later)> pair;
  std::function<harmonize::FilledFrame(const smooth::FramePair* before, const harmonize::FilledFrame& frame,
                                       const smooth::FramePair* after)>
      smooth;
};

/// The steps for single frames, each called from several threads.
struct FrameSteps {
  std::function<result::FilledView(std::size_t view)> fill;
  std::optional<Smoothing> smoothing;  ///< none: frames are not smoothed
  std::function<void(std::size_t view, const result::FilledView& finished)> write;
  std::size_t bytes_per_frame = 0;  ///< The memory that a frame takes in all steps; it limits the frames in progress.
};

/// Makes the smoothing, which adds its CPU time to the clock; none if it is switched off.
std::optional<Smoothing> make_smoothing(const smooth::SmoothOptions& options, result::CpuClock& cpu);

/// Fills the given targets of `views`, ascending, and the neighbors in their sequence that smoothing needs, in a pipeline: each
/// view is smoothed between its neighbors and written as soon as they are filled, while later views are filled. They are filled
/// in order of time, so that all cameras need the same source frames at the same time. A view is filled once, and a pair made
/// once.
void for_each_smoothed(const std::vector<std::size_t>& targets, const Views& views, const FrameSteps& steps);

}  // namespace dvi::run
