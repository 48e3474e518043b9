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

constexpr double kRadius = 3;  // px, of cv::inpaint

/// A hole pixel on its way from frame to frame.
struct Seeker {
  std::size_t pixel;
  cv::Point2f at;
};

/// All that move in one direction of time, and the view that they have come to.
struct Chain {
  std::size_t view;
  int direction;
  std::vector<Seeker> open;
};

// One frame on: those that come out of the masks have found their source, those that lose their way are dropped.
void advance(Chain& chain, const Views& views, const Lazy<HoleFlow>& flows, sample::Candidates& out) {
  const std::size_t next = chain.direction > 0 ? chain.view + 1 : chain.view - 1;
  const auto pair = flows[std::min(chain.view, next)];
  const cv::Mat2f& flow = chain.direction > 0 ? pair->forth : pair->back;
  const auto mask = views.masks[next];
  std::erase_if(chain.open, [&](Seeker& seeker) {
    sample::Candidate& candidate = out.leading[seeker.pixel];
    if (candidate.found()) return true;
    const std::optional<cv::Point2f> motion = HoleFlow::at(flow, seeker.at);
    if (!motion) return true;
    seeker.at += *motion;
    const cv::Point2f at = quantized(seeker.at.x, seeker.at.y);
    if (!can_sample(*mask, at)) return false;
    candidate = {static_cast<int>(next), at};
    return true;
  });
  chain.view = next;
}

// Where each hole pixel leaves the masks, in the frame nearest in time; forwards where both are as near.
sample::Candidates follow(const Views& views, std::size_t target, const Lazy<HoleFlow>& flows, int max_frames) {
  sample::Candidates out{Region(*views.masks[target]), {}};
  out.leading.resize(out.hole.size());
  const auto [first, last] = views.of_sequence(views[target].sequence);
  Chain forwards{target, 1, {}};
  for (std::size_t i = 0; i < out.hole.size(); ++i) forwards.open.push_back({i, cv::Point2f(out.hole.pixels[i])});
  Chain backwards{target, -1, forwards.open};
  for (int frame = 0; frame < max_frames; ++frame) {
    if (!forwards.open.empty() && forwards.view + 1 < last) advance(forwards, views, flows, out);
    if (!backwards.open.empty() && backwards.view > first) advance(backwards, views, flows, out);
  }
  return out;
}

// The candidates' colors as they are, with their receipts; black and of kind empty where there is none.
harmonize::FilledFrame copied(const sample::Candidates& candidates, const Views& views, std::size_t target) {
  harmonize::HarmonizeOptions as_is;
  as_is.poisson = false;
  as_is.unobserved = harmonize::Unobserved::leave;
  const cv::Mat1f no_depth(candidates.hole.index.size(), depth::DepthMap::kUnknown);
  return harmonize::harmonize({views, target, {no_depth, no_depth}, {}}, candidates, {}, as_is);
}

void inpaint_empty(harmonize::FilledFrame& frame, Inpainting method) {
  cv::Mat1b rest;
  cv::compare(frame.kind, static_cast<uchar>(harmonize::Kind::empty), rest, cv::CMP_EQ);
  const auto count = static_cast<std::size_t>(cv::countNonZero(rest));
  if (count == 0 || count == rest.total()) return;
  cv::Mat3b known, filled;
  frame.color.convertTo(known, CV_8U);
  cv::inpaint(known, rest, filled, kRadius, method == Inpainting::telea ? cv::INPAINT_TELEA : cv::INPAINT_NS);
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
  harmonize::FilledFrame frame = copied(none, views, target);
  inpaint_empty(frame, method);
  return frame;
}

Lazy<HoleFlow> hole_flows(const Views& views, const FlowOptions& options) {
  return {views.size() - 1, [views, options](std::size_t i) {
            return hole_flow(*views.images[i], *views.masks[i], *views.images[i + 1], *views.masks[i + 1],
                             options.consistency_px);
          }};
}

harmonize::FilledFrame flow_fill(const Views& views, std::size_t target, const Lazy<HoleFlow>& flows,
                                 const FlowOptions& options) {
  harmonize::FilledFrame frame = copied(follow(views, target, flows, options.max_frames), views, target);
  inpaint_empty(frame, Inpainting::telea);
  return frame;
}

}  // namespace dvi::baselines
