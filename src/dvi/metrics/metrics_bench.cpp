#include "dvi/metrics/metrics.h"

#include <benchmark/benchmark.h>

#include "dvi/metrics/test_scene.h"

namespace dvi::metrics {
namespace {

/// A frame of 1280x720, a result that lies half a pixel beside it, and a hole.
struct Pair {
  cv::Mat3b truth = scene({1280, 720}, 0), result = scene({1280, 720}, 0.5);
  cv::Mat1b hole = cv::Mat1b(720, 1280, uchar{0});
  Pair() { hole(cv::Rect(500, 300, 300, 210)) = 255; }
};

void differences(benchmark::State& state) {
  const Pair pair;
  for (auto _ : state) benchmark::DoNotOptimize(error_sums(pair.result, pair.truth, pair.hole));
}
BENCHMARK(differences)->Unit(benchmark::kMillisecond);

void similarity(benchmark::State& state) {
  const Pair pair;
  for (auto _ : state) benchmark::DoNotOptimize(ssim_map(pair.result, pair.truth));
}
BENCHMARK(similarity)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void misplaced(benchmark::State& state) {
  const Pair pair;
  for (auto _ : state) benchmark::DoNotOptimize(misplacement(pair.result, pair.truth, pair.hole));
}
BENCHMARK(misplaced)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace dvi::metrics
