#include "dvi/align/align.h"

#include <benchmark/benchmark.h>

#include "dvi/align/test_wall.h"

namespace dvi::align {
namespace {

/// Aligns a drive of 1280x720 with a jitter of 0.15 degrees, by number of frames. Runs once, because making the drive is slow.
void align_drive(benchmark::State& state) {
  const Camera camera{1280, 720, 1600, 1600, 639.5, 359.5, {}};
  const ShakyDrive drive(static_cast<std::size_t>(state.range(0)), {.jitter_deg = 0.15, .hole = {500, 300, 300, 210}}, camera);
  double residual = 0;
  for (auto _ : state) residual = drive.residual_deg(align(drive.views, {drive.map, drive.views}, {}).views);
  state.counters["residual_deg"] = residual;
}
BENCHMARK(align_drive)
    ->ArgName("frames")
    ->Arg(10)
    ->Arg(20)
    ->Arg(40)
    ->Arg(80)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace dvi::align
