#include "dvi/align/align.h"

#include <benchmark/benchmark.h>

#include "dvi/align/test_wall.h"

namespace dvi {
namespace {

/// A whole drive of ten frames of 320x240 with a jitter of +-0.15 degrees.
void align_drive(benchmark::State& state) {
  const ShakyDrive drive(10, {.jitter_deg = 0.15});
  double residual = 0;
  for (auto _ : state) {
    Views views = drive.views;
    residual = drive.residual_deg(align(views, drive.map, {}).views);
  }
  state.counters["residual_deg"] = residual;
}
BENCHMARK(align_drive)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace dvi
