#include "dvi/odometry/odometry.h"

#include <benchmark/benchmark.h>

#include "dvi/odometry/sharpness.h"
#include "dvi/testing/test_street.h"

namespace dvi::odometry {

namespace {

constexpr int kScans = 8, kBeams = 64, kColumns = 1800;

/// Eight scans of 64 beams, made beforehand, to poses; and how sharply these lay them together.
void follow(benchmark::State& state) {
  TestStreet street;
  street.beams = kBeams;
  street.columns = kColumns;
  const Drive drive = street.drive(TestStreet::path(8, 0.1), kScans);
  Odometry found = estimate_odometry(drive, {});
  for (auto _ : state) found = estimate_odometry(drive, {});
  state.counters["scans"] = kScans;
  state.counters["inliers"] = static_cast<double>(found.scans.back().inliers);
}
BENCHMARK(follow)->Unit(benchmark::kMillisecond);

void benchmark_sharpness(benchmark::State& state) {
  TestStreet street;
  street.beams = kBeams;
  street.columns = kColumns;
  const Drive drive = street.drive(TestStreet::path(8), kScans);
  Sharpness found = measure_sharpness(drive, TestStreet::path(8));
  for (auto _ : state) found = measure_sharpness(drive, TestStreet::path(8));
  state.counters["patches"] = static_cast<double>(found.ground_patches + found.vertical_patches);
}
BENCHMARK(benchmark_sharpness)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::odometry
