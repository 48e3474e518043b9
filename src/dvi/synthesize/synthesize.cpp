#include "dvi/synthesize/synthesize.h"

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/core/threads.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/blur.h"
#include "dvi/image/color_range.h"
#include "dvi/image/enlarge.h"
#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"
#include "dvi/synthesize/adapt_to_boundary.h"
#include "dvi/synthesize/completed_views.h"
#include "dvi/synthesize/exemplars.h"
#include "dvi/synthesize/surface_guide.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

/// Parameters of copies that are replaced.
struct FragmentParams {
  int radius_px = 2;      ///< Copies that are at most twice as wide are replaced.
  int min_size_px = 200;  ///< Copies of fewer pixels between unobserved ones are replaced.
};
constexpr FragmentParams kFragment;

/// Unobserved parts that are at most twice as wide are interpolated.
constexpr int kThinRadiusPx = 2;

/// Margin around the synthesized pixels in which surfaces are known.
constexpr int kGuideMarginPx = 4;

/// Parameters of the fine contrast, which confidence depends on.
struct FineContrastParams {
  double fine_sigma_px = 2;  ///< Details smaller than this are fine.
  double mean_sigma_px = 6;  ///< Size of the surroundings of a pixel.
};
constexpr FineContrastParams kFineContrast;

/// Measures the fine contrast around each pixel, in gray levels.
cv::Mat1f measure_fine_contrast(const cv::Mat3f& color) {
  cv::Mat1f gray, smooth;
  cv::transform(color, gray, cv::Matx13f::all(1.0F / 3));
  cv::GaussianBlur(gray, smooth, {}, kFineContrast.fine_sigma_px);
  return blurred(cv::Mat1f(cv::abs(gray - smooth)), kFineContrast.mean_sigma_px);
}

/// Returns the probability that a synthesized pixel is within 10 gray levels of the truth, by its distance in pixels to the
/// nearest known or copied pixel, and by the contrast around it (docs/algorithms/confidence.md).
double confidence_of_synthesis(float distance_px, float contrast) {
  return 1 / (1 + std::exp(-1.36 - 1.75 * std::exp(-distance_px / 9) + 1.95 * std::log1p(contrast)));
}

/// Writes the probability of each pixel of a region that it is within 10 gray levels of the truth.
void write_confidence(const Region& region, harmonize::FilledFrame& out) {
  const cv::Mat1b unobserved(out.kind >= static_cast<uchar>(Kind::interpolated));
  const cv::Rect box = enlarge(cv::boundingRect(unobserved), 1, unobserved.size());
  cv::Mat1f distance;
  cv::distanceTransform(unobserved(box), distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  const cv::Mat1f contrast = measure_fine_contrast(out.color);
  for (const cv::Point p : region.pixels)
    out.confidence(p) = static_cast<uchar>(std::lround(255 * confidence_of_synthesis(distance(p - box.tl()), contrast(p))));
}

/// Finds copies between unobserved pixels that are narrow or small: their depth is often wrong, and they look like dirt.
cv::Mat1b find_fragments(const cv::Mat1b& kind) {
  const cv::Mat1b observed(kind < static_cast<uchar>(Kind::interpolated));
  cv::Mat1b kept = grown(grown(observed, -kFragment.radius_px), kFragment.radius_px);
  cv::Mat1i labels;
  const int count = label_connected_parts(kept, labels);
  std::vector<int> sizes(count + 1, 0);
  for (int y = 0; y < kind.rows; ++y)
    for (int x = 0; x < kind.cols; ++x)
      sizes[labels(y, x)] += kind(y, x) == static_cast<uchar>(Kind::original) ? kFragment.min_size_px : 1;
  for (int y = 0; y < kind.rows; ++y)
    for (int x = 0; x < kind.cols; ++x)
      if (sizes[labels(y, x)] < kFragment.min_size_px) kept(y, x) = 0;
  return cv::Mat1b((kind > static_cast<uchar>(Kind::original)) & observed & ~kept);
}

/// Interpolates the pixels of `inner` from all pixels around them that are not in `other`.
void interpolate(cv::Mat3f& color, const cv::Mat1b& inner, const cv::Mat1b& other) {
  constexpr float kAnchor = 1e-4F;  // for parts without surroundings
  PoissonSystem system{Region(inner), {}, {}, 1};
  const cv::Rect inside({}, inner.size());
  std::vector<cv::Vec3f> x;
  for (const cv::Point p : system.region.pixels) {
    float diagonal = kAnchor;
    cv::Vec3f right = kAnchor * color(p);
    for (const cv::Point q : four_neighbors(p)) {
      if (!inside.contains(q) || (inner(q) == 0 && other(q) != 0)) continue;
      diagonal += 1;
      if (inner(q) == 0) right += color(q);
    }
    system.diagonal.push_back(diagonal);
    system.right.push_back(right);
    x.push_back(color(p));
  }
  solve_poisson(system, x);
  for (std::size_t i = 0; i < x.size(); ++i) color(system.region.pixels[i]) = x[i];
}

/// Completes the parts in parallel. At coarse levels, patches of a part may have pixels of another part as before its
/// completion.
void complete_parts(const std::vector<UnknownPart>& parts, const cv::Mat1b& usable, std::size_t seed, SynthesizedFrame& frame) {
  cv::Mat3f& color = frame.frame.color;
  std::vector<cv::Mat3f> completed;
  for (const UnknownPart& part : parts) completed.push_back(color(part.box).clone());
  parallel_for(parts.size(), [&](std::size_t i) {
    const UnknownPart& part = parts[i];
    complete_from_exemplars(completed[i], {part.unknown, usable(part.box)}, frame.guide.of(part.box), seed);
  });
  for (std::size_t i = 0; i < parts.size(); ++i) completed[i].copyTo(color(parts[i].box), parts[i].unknown);
}

/// Limits colors to those of the original pixels of the frame, because gains are wrong in black and in white frames. Pixels are
/// read until their range contains all colors of the region.
void limit_to_original(const Region& region, harmonize::FilledFrame& frame) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const ColorRange none{cv::Vec3f::all(kInfinity), cv::Vec3f::all(-kInfinity)};
  ColorRange wanted = none, range = none;
  for (const cv::Point p : region.pixels) wanted = wanted.with(frame.color(p));
  for (int y = 0; y < frame.kind.rows && !range.contains(wanted); ++y)
    for (int x = 0; x < frame.kind.cols; ++x)
      if (frame.kind(y, x) == static_cast<uchar>(Kind::original)) range = range.with(frame.color(y, x));
  if (range.low[0] > range.high[0]) return;  // no original pixels
  for (const cv::Point p : region.pixels) frame.color(p) = range.clamp(frame.color(p));
}

}  // namespace

SynthesizedFrame synthesize(ClassifiedFrame classified, const Views& views, std::size_t index,
                            const CompletedViews& completed) {
  SynthesizedFrame out{std::move(classified.filled), {}, {}};
  harmonize::FilledFrame& made = out.frame;
  out.completed = cv::Mat1b(made.kind.size(), uchar{0});
  const cv::Mat1b unobserved(made.kind >= static_cast<uchar>(Kind::interpolated));
  const cv::Mat1b wanted((made.kind == static_cast<uchar>(Kind::interpolated)) | find_fragments(made.kind));
  if (cv::countNonZero(wanted) == 0) return out;
  for (cv::Mat* changed :
       std::initializer_list<cv::Mat*>{&made.color, &made.kind, &made.confidence, &made.provenance, &made.used})
    *changed = changed->clone();
  made.kind.setTo(static_cast<uchar>(Kind::synthesized), wanted);
  made.provenance.setTo(0, wanted);
  made.used.setTo(0, wanted);
  {
    const ShownPixels shown = show_completed_views(completed, views, views[index], wanted);
    shown.color.copyTo(made.color, shown.shown);
    out.completed = wanted & ~shown.shown;
  }
  // Patches are too large for gaps between completed views.
  const cv::Mat1b wide(grown(grown(out.completed, -kThinRadiusPx), kThinRadiusPx + 1) & out.completed);
  interpolate(made.color, cv::Mat1b(out.completed & ~wide), wide);
  const cv::Mat1b usable(~unobserved & ~wanted);
  const std::vector<UnknownPart> parts = divide_for_search(wide, usable);
  cv::Mat1b where = grown(wanted, kGuideMarginPx);
  for (const UnknownPart& part : parts) where(part.box).setTo(255);
  out.guide = guide_by_surfaces({made, classified.classes, classified.ground}, views[index], where);
  complete_parts(parts, usable, index, out);
  out.guide.ground.release();
  adapt_to_boundary(made.color, wanted, out.guide);
  limit_to_original(Region(wanted), made);
  write_confidence(Region(wanted), made);
  return out;
}

}  // namespace dvi::synthesize
