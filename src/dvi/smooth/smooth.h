#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/options.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::smooth {

struct SmoothOptions {
  bool enabled = true;
  bool replace_outliers = true;

  void describe(OptionTable& table) {
    table.section("stages");
    table.developer();
    table.add("smooth", enabled, "Average the hole along optical flow over neighboring frames.");
    table.section("smooth");
    table.developer();
    table.add("replace_outliers", replace_outliers,
              "First replace colors that neither neighboring frame shows, if these two agree or the flow is consistent, by "
              "the median of the three.");
  }
};

/// A part of a filled frame.
struct FrameWindow {
  FrameWindow(const harmonize::FilledFrame& frame, const cv::Rect& box)
      : color(frame.color(box).clone()), mask(frame.mask(box).clone()), kind(frame.kind(box).clone()) {}

  cv::Mat3f color;
  cv::Mat1b mask, kind;
};

/// The same box of two frames, and the optical flow (DIS) between them in the box, in pixels.
struct FlowWindow {
  cv::Rect box;
  FrameWindow earlier, later;
  cv::Mat2f forward, backward;  ///< from the earlier frame to the later one, and back
};

/// Two consecutive filled frames around the holes of both.
struct FramePair {
  FramePair(const harmonize::FilledFrame& earlier, const harmonize::FilledFrame& later);

  cv::Vec3f earlier_gain, later_gain;
  std::vector<FlowWindow> windows;  ///< without overlap
};

/// Parameters of temporal smoothing.
struct SmoothParams {
  int margin_px = 64;          ///< around the hole, for the flow
  float max_mismatch_px = 1;   ///< of forward and backward flow
  float color_scale = 20;      ///< gray levels at which the weight of a neighboring frame is 1/e
  float min_outlier = 15;      ///< gray levels from both neighbors; right interpolated texture differs by up to 10
  int comparison_step_px = 4;  ///< between the compared pixels around the hole
};
inline constexpr SmoothParams kSmooth;

/// Smooths the hole of a frame by a weighted average along optical flow with the frames before and after (section 3.6 of the
/// paper). It is the later frame of `before` and the earlier one of `after`; both may be null at the ends of the drive. First
/// replaces colors that differ from both neighbors.
harmonize::FilledFrame smooth(const FramePair* before, const harmonize::FilledFrame& frame, const FramePair* after,
                              const SmoothOptions& options = {});

}  // namespace dvi::smooth
