#include "dvi/audit/coverage.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "dvi/core/threads.h"
#include "dvi/depth/depths.h"

namespace dvi::audit {
namespace {

/// The numbers of hole pixels of a frame.
struct HoleCount {
  std::size_t copied = 0, elsewhere = 0, hole = 0;
};

HoleCount count_pixels(const sample::Candidates& candidates, const Views& views) {
  HoleCount out;
  for (const sample::Candidate& candidate : candidates.leading) {
    ++out.hole;
    if (!candidate.found()) continue;
    ++(views[static_cast<std::size_t>(candidate.view)].sequence == 0 ? out.copied : out.elsewhere);
  }
  return out;
}

HoleShares to_shares(const HoleCount& c) {
  if (c.hole == 0) return {};
  const auto hole = static_cast<double>(c.hole);
  return {static_cast<double>(c.copied) / hole, static_cast<double>(c.elsewhere) / hole,
          static_cast<double>(c.hole - c.copied - c.elsewhere) / hole};
}

cv::Mat1b subsample(const cv::Mat1b& mask, int step) {
  cv::Mat1b out((mask.rows + step - 1) / step, (mask.cols + step - 1) / step);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out(y, x) = mask(step * y, step * x);
  return out;
}

}  // namespace

Views subsample(const Views& views, int step) {
  Views out;
  out.cleaned_sequences = views.cleaned_sequences;
  for (View view : views.views) {
    Camera& c = view.camera;
    c.width = (c.width + step - 1) / step;
    c.height = (c.height + step - 1) / step;
    for (double* length : {&c.fx, &c.fy, &c.cx, &c.cy}) *length /= step;
    out.views.push_back(view);
  }
  // Small enough to keep many, because a mask from labels may be slow to make.
  out.masks = {views.size(), 256, [masks = views.masks, step](std::size_t i) { return subsample(*masks[i], step); }};
  return out;
}

Coverage predict_coverage(const Views& views, const map::StaticMap& map, CoverageOptions options, const Tick& tick) {
  const Views coarse = subsample(views, options.step);
  int& median_px = options.depth.median_px;
  median_px = median_px >= 3 ? std::max(3, median_px / options.step) : 0;
  options.sample.sources = 1;
  const depth::Depths depths(coarse, [&](std::size_t i) { return depth::compute_depth_map(map, coarse[i], options.depth); });
  const std::size_t frames = coarse.targets();
  std::vector<HoleCount> counts(frames);
  parallel_in_order(frames, [&](std::size_t i) {
    const depth::DepthMap depth = depths.make_map(i);
    counts[i] = count_pixels(sample::sample({coarse, i, depth, depths.visibility}, options.sample), coarse);
    tick();
  });
  Coverage out;
  HoleCount all;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto pixels = static_cast<double>(coarse[i].camera.width) * coarse[i].camera.height;
    out.frames.push_back({i, static_cast<double>(counts[i].hole) / pixels, to_shares(counts[i])});
    all.copied += counts[i].copied;
    all.elsewhere += counts[i].elsewhere;
    all.hole += counts[i].hole;
  }
  out.total = to_shares(all);
  return out;
}

}  // namespace dvi::audit
