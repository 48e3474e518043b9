#include "dvi/sample/sample.h"

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "dvi/drive/flat_scene.h"

namespace dvi {
namespace {

/// A hole of 60,000 pixels at 1280x720: a vehicle ahead that all sources mask at the same place, so that each of them sees a
/// little more of what it hid.
void sample_hole(benchmark::State& state) {
  const cv::Mat3b picture(720, 1280, cv::Vec3b());
  cv::Mat1b hole(picture.size(), uchar{0});
  cv::ellipse(hole, {700, 420}, {165, 115}, 0, 0, 360, 255, cv::FILLED);
  FlatScene scene(picture, hole);
  for (int k = 1; k <= state.range(0); ++k) {
    scene.add_source(240 * k / static_cast<int>(state.range(0)), picture);
    scene.masks.back() = hole;
  }
  const DepthMap depth{scene.depth(), cv::Mat1f(scene.depth().size(), 0.02F)};
  const VisibilityMap same = visibility_map(depth, hole, 2);
  const Lazy<VisibilityMap> visibility(scene.views.size(), scene.views.size(), [&](std::size_t) { return same; });
  const Views views = scene.lazy();
  Candidates out;
  for (auto _ : state) out = sample(views, 0, depth, visibility, {});
  std::size_t found = 0;
  for (const Candidate& c : out.of) found += c.found() ? 1 : 0;
  state.counters["pixels"] = static_cast<double>(out.of.size());
  state.counters["found_part"] = static_cast<double>(found) / static_cast<double>(out.of.size());
}
BENCHMARK(sample_hole)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi
