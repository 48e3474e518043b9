#pragma once

#include "dvi/core/options.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::smooth {

struct SmoothOptions {
  bool enabled = true;

  void describe(OptionTable& table) {
    table.section("smooth");
    table.add("enabled", enabled, "Average the hole along the optical flow to the frames before and after.");
  }
};

/// The frame with its hole averaged with where the flow (DIS, forward and backward) finds it in the frames before and after
/// (null at the ends of the drive).
harmonize::FilledFrame smooth(const harmonize::FilledFrame* before, const harmonize::FilledFrame& frame,
                              const harmonize::FilledFrame* after, const SmoothOptions& options);

}  // namespace dvi::smooth
