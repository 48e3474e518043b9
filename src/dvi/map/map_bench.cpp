#include <algorithm>
#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>

#include "dvi/core/random.h"
#include "dvi/drive/deskew.h"
#include "dvi/drive/free_space.h"
#include "dvi/geometry/angles.h"
#include "dvi/map/build_map.h"
#include "dvi/map/visible_points.h"

namespace dvi::map {
namespace {

constexpr std::int64_t kScanPeriodNs = 100'000'000;
constexpr int kScans = 8, kBeams = 64, kColumns = 1800;

/// Returns the range of a ray from 1.7 m above a street: ground, facades 9 m to both sides, nothing above 6 m.
float trace_street(const Eigen::Vector3f& ray) {
  const float ground = ray.z() < 0 ? -1.7F / ray.z() : 1e9F;
  const float facade = 9 / std::max(std::abs(ray.y()), 1e-6F);
  return std::min(ground, facade * ray.z() < 4.3F ? facade : 1e9F);
}

/// A scan in the street; all positions along it differ in noise only.
Scan make_street_scan(std::uint64_t seed) {
  Random random(seed);
  Scan scan;
  for (int column = 0; column < kColumns; ++column)
    for (int beam = 0; beam < kBeams; ++beam) {
      const double azimuth = 2 * std::numbers::pi * (0.5 - (column + 0.5) / kColumns);
      const double elevation = to_radians(-24.8 + 26.8 * beam / (kBeams - 1));
      const Eigen::Vector3f ray =
          Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
              .cast<float>();
      const float range = trace_street(ray);
      if (range > 120) continue;
      scan.points.emplace_back((range + 0.02F * static_cast<float>(random.normal())) * ray);
      scan.intensity.push_back(0.5F);
      scan.time.push_back(static_cast<float>(0.1 * ((column + 0.5) / kColumns - 0.5)));
    }
  return scan;
}

/// Scans and frames of a car at 8 m/s; a vehicle ahead is masked.
struct StreetDrive {
  Drive drive;
  Trajectory poses;
  Lazy<cv::Mat1b> masks{kScans, kScans, [](std::size_t) {
                          cv::Mat1b mask(720, 1280, uchar{0});
                          mask(cv::Rect(500, 300, 300, 210)) = 255;
                          return mask;
                        }};

  StreetDrive() {
    drive.camera = {1280, 720, 1000, 1000, 639.5, 359.5, {}};
    drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    std::vector<StampedPose> stamped;
    for (int i = -1; i <= kScans; ++i) {
      const std::int64_t time = i * kScanPeriodNs;
      stamped.push_back({time, {Eigen::Matrix3d::Identity(), {0.8 * i, 0, 0}}});
      if (i < 0 || i == kScans) continue;
      drive.frames.push_back({i, "", time, {}, {}});
      drive.scan_headers.push_back({"", time, time - kScanPeriodNs / 2, time + kScanPeriodNs / 2, {}});
    }
    drive.scans = {kScans, kScans, make_street_scan};
    poses = Trajectory(stamped);
  }

  StaticMap map(bool require_camera_visibility, bool carve = false) const {
    MapOptions options;
    options.require_camera_visibility = require_camera_visibility;
    options.carve = carve;
    return build_map({{&drive, poses, masks}}, options);
  }
};

void deskew(benchmark::State& state) {
  const StreetDrive street;
  const auto scan = street.drive.scans[0];
  for (auto _ : state) benchmark::DoNotOptimize(to_world(*scan, street.drive.scan_headers[0], street.poses));
  state.counters["points"] = static_cast<double>(scan->size());
}
BENCHMARK(deskew)->Unit(benchmark::kMillisecond);

/// Builds a map from eight scans in memory, with camera visibility (first argument) and carving (second argument).
void build(benchmark::State& state) {
  const StreetDrive street;
  StaticMap map = street.map(false);  // makes the scans
  for (auto _ : state) map = street.map(state.range(0) != 0, state.range(1) != 0);
  state.counters["returns"] = static_cast<double>(map.counts.returns);
  state.counters["points"] = static_cast<double>(map.points.size());
}
BENCHMARK(build)
    ->Args({1, 0})
    ->Args({0, 0})
    ->Args({1, 1})
    ->Args({0, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

/// Prepares the free space of one scan.
void free_space(benchmark::State& state) {
  const StreetDrive street;
  const auto scan = street.drive.scans[0];
  for (auto _ : state) benchmark::DoNotOptimize(FreeSpace(*scan, street.drive.scan_headers[0], street.poses, 0.05));
}
BENCHMARK(free_space)->Unit(benchmark::kMillisecond);

void visible(benchmark::State& state) {
  const StreetDrive street;
  const StaticMap map = street.map(false);
  View view;
  view.camera = street.drive.camera;
  view.camera_from_world = street.drive.camera_from_lidar;
  std::vector<VisiblePoint> points;
  for (auto _ : state) points = find_visible_points(map, view, 0.07, 0.05);
  state.counters["map_points"] = static_cast<double>(map.points.size());
  state.counters["visible"] = static_cast<double>(points.size());
}
BENCHMARK(visible)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::map
