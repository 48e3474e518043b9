#include "dvi/depth/depth.h"

#include <benchmark/benchmark.h>

#include "dvi/core/random.h"
#include "dvi/depth/delaunay.h"
#include "dvi/depth/visibility_map.h"

namespace dvi::depth {
namespace {

/// A map of a street of 60 m: ground, facades at both sides, and trunks along the curbs.
map::StaticMap street_map(int points) {
  map::StaticMap map;
  Random random(5);
  const auto add = [&](double x, double y, double z) { map.points.push_back({Eigen::Vector3d(x, y, z).cast<float>(), 0, 1}); };
  for (int i = 0; i < 7 * (points / 10); ++i) add(random.uniform(3, 60), random.uniform(-9, 9), -1.7);
  for (int i = 0; i < points / 4; ++i) add(random.uniform(3, 60), i % 2 == 0 ? 9 : -9, random.uniform(-1.7, 4));
  for (int i = 0; i < points / 20; ++i) {
    const double angle = random.uniform(0, 6.2832);
    add(8 + 6 * (i % 8) + 0.2 * std::cos(angle), (i % 2 == 0 ? 5 : -5) + 0.2 * std::sin(angle), random.uniform(-1.7, 3));
  }
  Eigen::AlignedBox3f bounds;
  for (const map::MapPoint& p : map.points) bounds.extend(p.position);
  map.tiles = {{bounds, 0, map.points.size()}};
  return map;
}

View street_view() {
  View view;
  view.camera = {1280, 720, 1000, 1000, 639.5, 359.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return view;
}

/// compute_depth_map() at 1280x720, by points of the map; with split = 0 in the published form.
void depth(benchmark::State& state) {
  const map::StaticMap map = street_map(static_cast<int>(state.range(0)));
  DepthOptions options;
  options.split_edges = state.range(1) != 0;
  DepthMap out;
  for (auto _ : state) out = compute_depth_map(map, street_view(), options);
  int known = 0;
  for (const float z : out.z) known += DepthMap::is_surface(z) ? 1 : 0;
  state.counters["known_part"] = known / static_cast<double>(out.z.total());
}
BENCHMARK(depth)
    ->ArgNames({"points", "split"})
    ->Args({50'000, 1})
    ->Args({200'000, 1})
    ->Args({800'000, 1})
    ->Args({200'000, 0})
    ->Unit(benchmark::kMillisecond);

void triangulate(benchmark::State& state) {
  const DepthOptions options;
  const auto points = map::find_visible_points(street_map(static_cast<int>(state.range(0))), street_view(), options.splat_m,
                                               options.occlusion_tolerance);
  std::size_t triangles = 0;
  for (auto _ : state) {
    triangles = 0;
    dvi::depth::triangulate(points, [&](const std::array<std::size_t, 3>&) { ++triangles; });
  }
  state.counters["visible"] = static_cast<double>(points.size());
  state.counters["triangles"] = static_cast<double>(triangles);
}
BENCHMARK(triangulate)->ArgName("points")->Arg(50'000)->Arg(200'000)->Arg(800'000)->Unit(benchmark::kMillisecond);

void visibility(benchmark::State& state) {
  const DepthMap depth = compute_depth_map(street_map(200'000), street_view(), {});
  cv::Mat1b mask(depth.z.size(), uchar{0});
  mask(cv::Rect(500, 300, 300, 210)) = 255;
  for (auto _ : state) benchmark::DoNotOptimize(make_visibility_map(depth, mask));
}
BENCHMARK(visibility)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::depth
