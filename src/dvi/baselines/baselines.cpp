#include "dvi/baselines/baselines.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "dvi/drive/warp.h"
#include "dvi/harmonize/confidence.h"
#include "dvi/harmonize/harmonize.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::baselines {
namespace {

constexpr double kInpaintRadiusPx = 3;

/// A hole pixel that is tracked from frame to frame.
struct TrackedPixel {
  std::size_t pixel;
  cv::Point2f position;
};

/// The pixels that are tracked in one direction of time, and the current view.
struct FlowChain {
  std::size_t view;
  int direction;
  std::vector<TrackedPixel> open;
};

/// Tracks the pixels to the next frame: pixels outside its mask have found their source, pixels with inconsistent flow are
/// dropped.
void advance(FlowChain& chain, const Views& views, const Lazy<HoleFlow>& flows, sample::Candidates& out) {
  const std::size_t next = chain.direction > 0 ? chain.view + 1 : chain.view - 1;
  const auto pair = flows[std::min(chain.view, next)];
  const cv::Mat2f& flow = chain.direction > 0 ? pair->forward : pair->backward;
  const auto mask = views.masks[next];
  std::erase_if(chain.open, [&](TrackedPixel& tracked) {
    sample::Candidate& candidate = out.leading[tracked.pixel];
    if (candidate.found()) return true;
    const std::optional<cv::Point2f> motion = HoleFlow::interpolate(flow, tracked.position);
    if (!motion) return true;
    tracked.position += *motion;
    const cv::Point2f at = quantize(tracked.position.x, tracked.position.y);
    if (!can_sample(*mask, at)) return false;
    candidate = {static_cast<int>(next), at};
    return true;
  });
  chain.view = next;
}

/// Finds the source of each hole pixel, in the nearest frame in time; in the later one if both are equally near.
sample::Candidates track(const Views& views, std::size_t target, const Lazy<HoleFlow>& flows, int max_frames) {
  sample::Candidates out{Region(*views.masks[target]), {}};
  out.leading.resize(out.hole.size());
  const auto [first, last] = views.of_sequence(views[target].sequence);
  FlowChain forward{target, 1, {}};
  for (std::size_t i = 0; i < out.hole.size(); ++i) forward.open.push_back({i, cv::Point2f(out.hole.pixels[i])});
  FlowChain backward{target, -1, forward.open};
  for (int frame = 0; frame < max_frames; ++frame) {
    if (!forward.open.empty() && forward.view + 1 < last) advance(forward, views, flows, out);
    if (!backward.open.empty() && backward.view > first) advance(backward, views, flows, out);
  }
  return out;
}

/// Copies the colors of the candidates, with their provenance; pixels without candidate are black, with kind empty.
harmonize::FilledFrame copy_colors(const sample::Candidates& candidates, const Views& views, std::size_t target) {
  harmonize::HarmonizeOptions options;
  options.poisson = false;
  options.unobserved = harmonize::Unobserved::leave;
  const cv::Mat1f no_depth(candidates.hole.index.size(), depth::DepthMap::kUnknown);
  return harmonize::harmonize({views, target, {no_depth, no_depth}, {}}, candidates, {}, options);
}

void inpaint_empty(harmonize::FilledFrame& frame, Inpainting method) {
  cv::Mat1b rest;
  cv::compare(frame.kind, static_cast<uchar>(harmonize::Kind::empty), rest, cv::CMP_EQ);
  const auto count = static_cast<std::size_t>(cv::countNonZero(rest));
  if (count == 0 || count == rest.total()) return;
  cv::Mat3b known, filled;
  frame.color.convertTo(known, CV_8U);
  cv::inpaint(known, rest, filled, kInpaintRadiusPx, method == Inpainting::telea ? cv::INPAINT_TELEA : cv::INPAINT_NS);
  cv::Mat1f distance;
  cv::distanceTransform(rest, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (const cv::Point p : Region(rest).pixels) {
    frame.color(p) = filled(p);
    frame.kind(p) = static_cast<uchar>(harmonize::Kind::interpolated);
    frame.confidence(p) = static_cast<uchar>(std::lround(255 * harmonize::confidence_of_interpolation(distance(p))));
  }
}

}  // namespace

harmonize::FilledFrame inpaint_frame(const Views& views, std::size_t target, Inpainting method) {
  sample::Candidates none{Region(*views.masks[target]), {}};
  none.leading.resize(none.hole.size());
  harmonize::FilledFrame frame = copy_colors(none, views, target);
  inpaint_empty(frame, method);
  return frame;
}

Lazy<HoleFlow> make_hole_flows(const Views& views, const FlowOptions& options) {
  return {views.size() - 1, [views, options](std::size_t i) {
            return compute_hole_flow({*views.images[i], *views.masks[i]}, {*views.images[i + 1], *views.masks[i + 1]},
                                     options.consistency_px);
          }};
}

harmonize::FilledFrame fill_along_flow(const Views& views, std::size_t target, const Lazy<HoleFlow>& flows,
                                       const FlowOptions& options) {
  harmonize::FilledFrame frame = copy_colors(track(views, target, flows, options.max_frames), views, target);
  inpaint_empty(frame, Inpainting::telea);
  return frame;
}

}  // namespace dvi::baselines
