#include <benchmark/benchmark.h>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/smooth/smooth.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::smooth {
namespace {

harmonize::FilledFrame make_frame(int shift, cv::Rect hole) {
  harmonize::FilledFrame frame;
  const cv::Mat3b wide = waves(1360, 720, 1, 12);
  wide(cv::Rect(40 + shift, 0, 1280, 720)).convertTo(frame.color, CV_32FC3);
  frame.mask = cv::Mat1b(720, 1280, uchar{0});
  frame.mask(hole) = 255;
  frame.kind = frame.mask / 255;
  return frame;
}

/// Smooths a hole in 1280x720 with the given width in pixels and 0.7 times this height.
void smooth_hole(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const cv::Rect hole = cv::Rect(640 - width / 2, 360 - width * 7 / 20, width, width * 7 / 10) & cv::Rect(0, 0, 1280, 720);
  const harmonize::FilledFrame before = make_frame(-6, hole), frame = make_frame(0, hole), after = make_frame(6, hole);
  for (auto _ : state) {  // as in a drive, in which one pair was made for the frame before
    state.PauseTiming();
    const FramePair to_before(before, frame);
    state.ResumeTiming();
    const FramePair to_after(frame, after);
    benchmark::DoNotOptimize(smooth(&to_before, frame, &to_after));
  }
  state.counters["pixels"] = hole.area();
}
BENCHMARK(smooth_hole)->Arg(300)->Arg(1100)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace dvi::smooth
