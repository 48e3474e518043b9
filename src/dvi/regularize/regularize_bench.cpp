#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/image/region.h"
#include "dvi/regularize/belief_propagation.h"
#include "dvi/regularize/labeling.h"
#include "dvi/regularize/regularize.h"
#include "dvi/regularize/shift_field.h"
#include "dvi/regularize/test_tree_reweighted.h"
#include "dvi/sample/candidates.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::regularize {
namespace {

/// An elliptic hole at 1280x720 with candidates from 12 noisy sources. Candidates are displaced by up to a pixel: equally
/// within patches, or each independently.
struct Hole {
  FlatScene scene{waves(1280, 720, 1, 10), cv::Mat1b(720, 1280, uchar{0})};
  sample::Candidates candidates;

  Hole(double pixels, bool independent) {
    const cv::Mat3b truth = scene.images[0].clone();
    const double scale = std::sqrt(pixels / 60'000);
    cv::ellipse(scene.masks[0], {700, 420}, cv::Size(cvRound(165 * scale), cvRound(115 * scale)), 0, 0, 360, 255, cv::FILLED);
    Random random(2);
    for (int k = 0; k < 12; ++k) {
      cv::Mat3b noisy = truth.clone();
      for (cv::Vec3b& v : noisy)
        for (int c = 0; c < 3; ++c) v[c] = cv::saturate_cast<uchar>(v[c] + 3 * random.normal());
      scene.add_source(4 * k - 20, noisy);
    }
    candidates.hole = Region(scene.masks[0]);
    for (const cv::Point p : candidates.hole.pixels) {
      const int k = (p.x / 40 + p.y / 25) % 12;
      candidates.leading.push_back({k + 1, cv::Point2f(p + cv::Point(4 * k - 20, 0)) +
                                               cv::Point2f(independent ? cv::Point(random.below(3) - 1, random.below(3) - 1)
                                                                       : cv::Point(k % 3 - 1, k % 2))});
    }
  }
  depth::DepthMap depth() const { return {scene.depth(), scene.depth()}; }
};

void regularize_hole(benchmark::State& state) {
  const Hole hole(static_cast<double>(state.range(0)), state.range(1) != 0);
  const Views views = hole.scene.lazy();
  const depth::DepthMap depth = hole.depth();
  Labeling out;
  for (auto _ : state) {
    out = regularize(hole.candidates, {views, 0, depth, {}}, {true});
    benchmark::DoNotOptimize(out);
  }
  state.counters["pixels"] = static_cast<double>(hole.candidates.leading.size());
  state.counters["iterations"] = out.iterations;
  state.counters["energy_part"] = out.energy->after / out.energy->before;
}
BENCHMARK(regularize_hole)->Args({60'000, 0})->Args({100'000, 0})->Args({60'000, 1})->Unit(benchmark::kMillisecond);

/// Compares the energy of belief propagation with that of a stronger solver and its lower bound, relative to the energy before.
void compare_with_trw_s(benchmark::State& state) {
  const Hole hole(static_cast<double>(state.range(0)), state.range(1) != 0);
  const RegularizeOptions options;
  const ShiftField field =
      make_shift_field(hole.candidates, {hole.scene.lazy(), 0, hole.depth(), {}}, options.window, options.alpha);
  const BeliefPropagation found = propagate_beliefs(field, options.iterations);
  for (auto _ : state) {
    const TreeReweighted reference(field, 50);
    state.counters["trw_s_part"] = reference.energy() / found.energy_before;
    state.counters["bound_part"] = reference.bound() / found.energy_before;
  }
  state.counters["energy_part"] = found.energy_after / found.energy_before;
}
BENCHMARK(compare_with_trw_s)->Args({2'000, 0})->Args({2'000, 1})->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace dvi::regularize
