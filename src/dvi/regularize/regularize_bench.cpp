#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/flat_scene.h"
#include "dvi/drive/view.h"
#include "dvi/image/region.h"
#include "dvi/regularize/labelling.h"
#include "dvi/regularize/regularize.h"
#include "dvi/sample/candidates.h"

namespace dvi::regularize {
namespace {

/// A hole of some 60,000 (or 100,000) pixels at 1280x720 with candidates from 12 noisy sources, off by up
/// to a pixel: alike in each patch, or (second argument) each pixel by itself.
void regularize_hole(benchmark::State& state) {
  const cv::Mat3b truth = waves(1280, 720, 1, 10);
  cv::Mat1b hole(truth.size(), uchar{0});
  const double scale = std::sqrt(static_cast<double>(state.range(0)) / 60'000);
  cv::ellipse(hole, {700, 420}, cv::Size(cvRound(165 * scale), cvRound(115 * scale)), 0, 0, 360, 255, cv::FILLED);
  FlatScene scene(truth, hole);
  Random random(2);
  for (int k = 0; k < 12; ++k) {
    cv::Mat3b noisy = truth.clone();
    for (cv::Vec3b& v : noisy)
      for (int c = 0; c < 3; ++c) v[c] = cv::saturate_cast<uchar>(v[c] + 3 * random.normal());
    scene.add_source(4 * k - 20, noisy);
  }
  const bool alone = state.range(1) != 0;
  sample::Candidates candidates{Region(hole), {}};
  for (const cv::Point p : candidates.hole.pixels) {
    const int k = (p.x / 40 + p.y / 25) % 12;
    candidates.leading.push_back(
        {k + 1, cv::Point2f(p + cv::Point(4 * k - 20, 0)) +
                    cv::Point2f(alone ? cv::Point(random.below(3) - 1, random.below(3) - 1) : cv::Point(k % 3 - 1, k % 2))});
  }
  const Views views = scene.lazy();
  const depth::DepthMap depth{scene.depth(), scene.depth()};
  Labelling out;
  for (auto _ : state) {
    out = regularize(candidates, views, 0, depth, {true});
    benchmark::DoNotOptimize(out);
  }
  state.counters["pixels"] = static_cast<double>(candidates.leading.size());
  state.counters["iterations"] = out.iterations;
  state.counters["energy_part"] = out.energy->after / out.energy->before;
}
BENCHMARK(regularize_hole)->Args({60'000, 0})->Args({100'000, 0})->Args({60'000, 1})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::regularize
