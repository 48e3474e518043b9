#include "dvi/align/align.h"

#include <benchmark/benchmark.h>

#include "dvi/align/pair_search.h"
#include "dvi/align/test_wall.h"

namespace dvi {
namespace {

/// The search between two frames alone: images, z-buffers and rings are made already.
void pair_search(benchmark::State& state) {
  const ShakyDrive drive(2, 0.3);
  const AlignOptions options;
  const Comparison comparison(drive.views, drive.map, options);
  const std::vector<Eigen::Vector2d> corrections(2, Eigen::Vector2d::Zero());
  auto match = comparison.match(0, 1, corrections);
  for (auto _ : state) {
    match = comparison.match(0, 1, corrections);
    benchmark::DoNotOptimize(match);
  }
  state.counters["points"] = match ? match->points : 0;
}
BENCHMARK(pair_search)->Unit(benchmark::kMillisecond);

/// A whole drive of ten frames of 320x240 with a jitter of +-0.15 degrees, three passes.
void align_drive(benchmark::State& state) {
  const ShakyDrive drive(10, 0.15);
  double residual = 0;
  for (auto _ : state) {
    Views views = drive.views;
    residual = drive.residual_deg(align(views, drive.map, {}));
  }
  state.counters["residual_deg"] = residual;
}
BENCHMARK(align_drive)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace dvi
