#pragma once

#include "dvi/core/options.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::smooth {

struct SmoothOptions {
  bool enabled = true;

  void describe(OptionTable& table) {
    table.section("stages");
    table.add("smooth", enabled, "Average the hole along optical flow over neighbouring frames.");
  }
  void check() const { check_ranges(*this); }
};

/// The frame with its hole averaged with where the flow (DIS, forward and backward) finds it in the frames before and after
/// (null at the ends of the drive).
harmonize::FilledFrame smooth(const harmonize::FilledFrame* before, const harmonize::FilledFrame& frame,
                              const harmonize::FilledFrame* after, const SmoothOptions& options);

}  // namespace dvi::smooth
