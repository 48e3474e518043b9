#include "dvi/metrics/metrics.h"

#include <benchmark/benchmark.h>

#include "dvi/metrics/test_scene.h"

namespace dvi::metrics {
namespace {

/// A frame of 1280x720, a result that is shifted by half a pixel, and a hole.
struct ShiftedResult {
  cv::Mat3b truth = make_scene({1280, 720}, 0), result = make_scene({1280, 720}, 0.5);
  cv::Mat1b hole = cv::Mat1b(720, 1280, uchar{0});
  ShiftedResult() { hole(cv::Rect(500, 300, 300, 210)) = 255; }
};

void benchmark_errors(benchmark::State& state) {
  const ShiftedResult pair;
  for (auto _ : state) benchmark::DoNotOptimize(sum_errors(pair.result, pair.truth, pair.hole));
}
BENCHMARK(benchmark_errors)->Unit(benchmark::kMillisecond);

void benchmark_ssim(benchmark::State& state) {
  const ShiftedResult pair;
  for (auto _ : state) benchmark::DoNotOptimize(compute_ssim(pair.result, pair.truth));
}
BENCHMARK(benchmark_ssim)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void benchmark_position_error(benchmark::State& state) {
  const ShiftedResult pair;
  for (auto _ : state) benchmark::DoNotOptimize(compute_position_error(pair.result, pair.truth, pair.hole));
}
BENCHMARK(benchmark_position_error)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace dvi::metrics
