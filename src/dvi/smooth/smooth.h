#pragma once

#include "dvi/core/options.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi {

struct SmoothOptions {
  bool enabled = true;

  void describe(OptionTable& table) {
    table.section("smooth");
    table.add("enabled", enabled, "Average the hole along the optical flow to the frames before and after.");
  }
};

/// The frame with its hole averaged with where the flow (DIS, forward and backward) finds it in the frames before and after
/// (null at the ends of the drive).
FilledFrame smooth(const FilledFrame* before, const FilledFrame& frame, const FilledFrame* after, const SmoothOptions& options);

}  // namespace dvi
