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
              "First replace what neither neighboring frame shows, where these two agree or the flow is sure, by the median of "
              "the three.");
  }
};

/// Optical flow (DIS) between two frames in a box of both, in pixels.
struct FlowWindow {
  cv::Rect box;
  cv::Mat2f forward, backward;  ///< from the earlier frame to the later one, and back
};

/// Two filled frames that follow each other, and the flow between them round the holes of either. It refers to both frames.
struct FramePair {
  FramePair(const harmonize::FilledFrame& first, const harmonize::FilledFrame& second);

  const harmonize::FilledFrame& earlier;
  const harmonize::FilledFrame& later;
  std::vector<FlowWindow> windows;  ///< do not overlap
};

/// The frame with its hole averaged with where the flow finds it in the frames before and after: before->later and
/// after->earlier are this frame; null at the ends of the drive. A color unlike those of both is replaced first.
harmonize::FilledFrame smooth(const FramePair* before, const harmonize::FilledFrame& frame, const FramePair* after,
                              const SmoothOptions& options = {});

}  // namespace dvi::smooth
