#include "dvi/synth/synth_options.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dvi/core/error.h"
#include "dvi/synth/scene.h"

namespace dvi::synth {
namespace {

TEST(SynthOptions, RefusesValuesOutOfRange) {
  const auto refused = [](auto change) {
    SynthOptions options;
    change(options);
    EXPECT_THROW(options.check(), UsageError);
  };
  refused([](SynthOptions& o) { o.frames = 0; });
  refused([](SynthOptions& o) { o.day = 10; });
  refused([](SynthOptions& o) { o.beams = -1; });
  refused([](SynthOptions& o) { o.speed_mps = std::nan(""); });
  refused([](SynthOptions& o) { o.turn_deg = 200; });
  refused([](SynthOptions& o) { o.lens = SynthLens::panorama; });
  refused([](SynthOptions& o) { o.six_cameras = o.side_cameras = true; });
  refused([](SynthOptions& o) { o.room = o.six_cameras = true; });
  SynthOptions options;
  options.width = 10;
  EXPECT_THROW(Scene{options}, UsageError);
}

}  // namespace
}  // namespace dvi::synth
