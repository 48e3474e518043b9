#include "dvi/sample/sample.h"

#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "dvi/testing/flat_scene.h"

namespace dvi::sample {
namespace {

/// sample() at 1280x720, by the number of sources and the pixels of the hole. The hole is a vehicle ahead that all sources mask
/// at the same image position, so that each source observes a little more of the background.
void sample_hole(benchmark::State& state) {
  const int sources = static_cast<int>(state.range(0));
  const double scale = std::sqrt(static_cast<double>(state.range(1)) / 60'000);
  const cv::Mat3b picture(720, 1280, cv::Vec3b());
  cv::Mat1b hole(picture.size(), uchar{0});
  cv::ellipse(hole, {420, 360}, {cvRound(165 * scale), cvRound(115 * scale)}, 0, 0, 360, 255, cv::FILLED);
  FlatScene scene(picture, hole);
  for (int k = 1; k <= sources; ++k) {
    scene.add_source(cvRound(240 * scale * k / sources), picture);
    scene.masks.back() = hole;
  }
  const depth::DepthMap depth{scene.depth(), cv::Mat1f(scene.depth().size(), 0.02F)};
  const depth::VisibilityMap same = depth::make_visibility_map(depth, hole);
  const Lazy<depth::VisibilityMap> visibility(scene.views.size(), scene.views.size(), [&](std::size_t) { return same; });
  const Views views = scene.lazy();
  Candidates out;
  for (auto _ : state) out = sample({views, 0, depth, visibility}, {});
  std::size_t found = 0;
  for (const Candidate& c : out.leading) found += c.found() ? 1 : 0;
  state.counters["found_part"] = static_cast<double>(found) / static_cast<double>(out.leading.size());
}
BENCHMARK(sample_hole)
    ->ArgNames({"sources", "pixels"})
    ->Args({10, 60'000})
    ->Args({20, 60'000})
    ->Args({40, 60'000})
    ->Args({20, 15'000})
    ->Args({20, 240'000})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::sample
