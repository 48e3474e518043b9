#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/harmonize.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::harmonize {
namespace {

/// harmonize() at 1280x720, by pixels of the hole. A tenth of it is unobserved, the rest has 12 sources of different
/// brightness.
void harmonize_hole(benchmark::State& state) {
  const cv::Mat3b truth = waves(1280, 720, 1, 10);
  cv::Mat1b hole(truth.size(), uchar{0});
  const double scale = std::sqrt(static_cast<double>(state.range(0)) / 60'000);
  cv::ellipse(hole, {700, 420}, cv::Size(cvRound(165 * scale), cvRound(115 * scale)), 0, 0, 360, 255, cv::FILLED);
  FlatScene scene(truth, hole);
  for (int k = 0; k < 12; ++k) {
    cv::Mat3b exposed;
    cv::add(truth, cv::Scalar::all(3 * k - 18), exposed);
    scene.add_source(4 * k - 20, exposed);
  }
  sample::Candidates candidates{Region(hole), {}};
  for (const cv::Point p : candidates.hole.pixels) {
    const int k = (p.x / 40 + p.y / 25) % 12;
    candidates.leading.push_back(p.y % 100 < 10 ? sample::Candidate{}
                                                : sample::Candidate{k + 1, cv::Point2f(p + cv::Point(4 * k - 20, 0))});
  }
  const Views views = scene.lazy();
  const depth::DepthMap depth{scene.depth(), scene.depth()};
  for (auto _ : state) benchmark::DoNotOptimize(harmonize({views, 0, depth, {}}, candidates, {}, {}));
  state.counters["pixels"] = static_cast<double>(candidates.leading.size());
}
BENCHMARK(harmonize_hole)->Arg(60'000)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::harmonize
