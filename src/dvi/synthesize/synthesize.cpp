#include "dvi/synthesize/synthesize.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/blur.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"
#include "dvi/synthesize/grain.h"
#include "dvi/synthesize/range.h"
#include "dvi/synthesize/surfaces.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

constexpr int kRing = 6;  // px round what is synthesized in which light and texture are compared

// Of the contrast of what surfaces and surroundings show: what is made up is to look real, not to stand out.
constexpr float kContrast = 0.6F, kGrain = 0.75F;

/// How much of the contrast of what the surfaces show is used. Where a pixel covers a meter of the ground, its height and the
/// offsets are off by more than a pixel.
float share_of(float span) {
  constexpr float kFine = 0.5F, kTooCoarse = 1;  // meters
  return kContrast * std::clamp((kTooCoarse - span) / (kTooCoarse - kFine), 0.0F, 1.0F);
}

/// The fine contrast of what was known or copied near each pixel, in gray levels.
cv::Mat1f fine_contrast(const harmonize::FilledFrame& frame) {
  constexpr double kFine = 2, kNear = 20;      // px
  constexpr float kPrior = 1e-3F, kUsual = 8;  // where there is nothing near
  cv::Mat1f gray, smooth;
  cv::transform(frame.color, gray, cv::Matx13f::all(1.0F / 3));
  cv::GaussianBlur(gray, smooth, {}, kFine);
  const cv::Mat1b seen(frame.kind < static_cast<uchar>(Kind::interpolated));
  cv::Mat1f fine(cv::abs(gray - smooth)), weight(gray.size(), 0.0F);
  fine.setTo(0, ~seen);
  weight.setTo(1, seen);
  return cv::Mat1f((blurred(fine, kNear) + kPrior * kUsual) / (blurred(weight, kNear) + kPrior));
}

/// Probability that a synthesized pixel is within 10 gray levels of the truth, by its distance in pixels to the nearest pixel
/// that was known or copied, and by the contrast there (docs/algorithms/confidence.md).
double synthesized_confidence(float distance, float contrast) {
  return 1 / (1 + std::exp(-3.83 - 2.83 * std::exp(-distance / 9) + 2.87 * std::log1p(contrast)));
}

/// What the surfaces show, and how the frame differs from it.
struct Texture {
  cv::Mat3f color, difference;
  cv::Mat1f share;
  cv::Mat1b known;  // 255
};

// Brings the texture into the light of the frame round it: light multiplies, so contrast goes with it, and a pattern of the sun
// does not shine in the shade.
void relight(Texture& texture, const cv::Mat3f& frame) {
  constexpr double kSigma = 10;  // px
  constexpr float kDark = 4, kMost = 2;
  cv::Mat3f of_frame(frame.size(), cv::Vec3f());
  frame.copyTo(of_frame, texture.known);
  cv::Mat1f known(frame.size(), 0.0F);
  known.setTo(1, texture.known);
  const cv::Mat3f shown = blurred(texture.color, kSigma), lit = blurred(of_frame, kSigma);
  const cv::Mat1f weight = blurred(known, kSigma);
  for (const cv::Point p : Region(texture.known).pixels)
    for (int c = 0; c < 3; ++c) {
      const float dark = kDark * weight(p);
      texture.color(p)[c] *= std::min((lit(p)[c] + dark) / (shown(p)[c] + dark), kMost);
      texture.difference(p)[c] = frame(p)[c] - texture.color(p)[c];
    }
}

Texture texture_of(const harmonize::FilledFrame& frame, const cv::Mat1b& wanted, const View& view, const cv::Mat1b& classes,
                   const Surfaces& surfaces) {
  const Region region(grown(wanted, kRing));
  const std::vector<SurfaceColor> found = surfaces.look_up(view, region, classes);
  const cv::Size size = wanted.size();
  Texture out{cv::Mat3f(size, cv::Vec3f()), cv::Mat3f(size, cv::Vec3f()), cv::Mat1f(size, 0.0F), cv::Mat1b(size, uchar{0})};
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point p = region.pixels[i];
    if (!(found[i].span > 0) || frame.kind(p) == static_cast<uchar>(Kind::empty)) continue;
    out.color(p) = found[i].color;
    out.share(p) = share_of(found[i].span);
    out.known(p) = 255;
  }
  relight(out, frame.color);
  return out;
}

// The mean of a difference over the ring near each of its pixels: a texture that is off by a pixel there must not run on
// inwards.
cv::Mat3f smoothed_ring(const Texture& texture, const cv::Mat1b& wanted) {
  constexpr double kSigma = 2;  // px
  const cv::Mat1b ring(texture.known & ~wanted);
  cv::Mat3f sum(ring.size(), cv::Vec3f());
  cv::Mat1f weight(ring.size(), 0.0F);
  texture.difference.copyTo(sum, ring);
  weight.setTo(1, ring);
  cv::GaussianBlur(sum, sum, {}, kSigma);
  cv::GaussianBlur(weight, weight, {}, kSigma);
  for (const cv::Point p : Region(ring).pixels) sum(p) /= weight(p);
  return sum;
}

// Screened Poisson equation of what is added to the texture: at the rim what the frame differs by there, and farther in what
// the interpolation differs by on average.
std::vector<cv::Vec3f> light(const Texture& texture, const cv::Mat1b& wanted, const Region& region) {
  constexpr float kHold = 1e-2F;  // beyond 10 px, 1 / sqrt(kHold), the interpolation tells the light
  const cv::Mat3f rim = smoothed_ring(texture, wanted);
  PoissonSystem system{region, {}, {}, 1};
  std::vector<cv::Vec3f> x;
  const cv::Rect inside({}, wanted.size());
  for (const cv::Point p : region.pixels) {
    float diagonal = kHold;
    cv::Vec3f right = kHold * texture.difference(p);
    for (const cv::Point q : {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)}) {
      if (!inside.contains(q) || texture.known(q) == 0) continue;
      diagonal += 1;
      if (wanted(q) == 0) right += rim(q);
    }
    system.diagonal.push_back(diagonal);
    system.right.push_back(right);
    x.push_back(texture.difference(p));
  }
  solve_poisson(system, x);
  return x;
}

}  // namespace

harmonize::FilledFrame synthesize(const harmonize::FilledFrame& frame, const View& view, const cv::Mat1b& surface_classes,
                                  const Textures& textures) {
  const cv::Mat1b wanted(frame.kind == static_cast<uchar>(Kind::interpolated));
  if (cv::countNonZero(wanted) == 0) return frame;
  const cv::Mat1b classes = surface_classes.empty() ? cv::Mat1b(wanted.size(), uchar{0}) : surface_classes;
  const Texture texture = texture_of(frame, wanted, view, classes, textures.surfaces);
  const Region region(wanted), textured(cv::Mat1b(wanted & texture.known));
  const std::vector<cv::Vec3f> lights = light(texture, wanted, textured),
                               grains = textures.grain.at(frame, region, view, classes);
  harmonize::FilledFrame out = frame;
  for (cv::Mat* changed : std::initializer_list<cv::Mat*>{&out.color, &out.kind, &out.confidence}) *changed = changed->clone();
  cv::Mat1f distance;
  cv::distanceTransform(cv::Mat1b(frame.kind >= static_cast<uchar>(Kind::interpolated)), distance, cv::DIST_L2,
                        cv::DIST_MASK_PRECISE);
  const cv::Mat1f contrast = fine_contrast(frame);
  const std::vector<ColorRange> ranges = ranges_round(frame, region);
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point p = region.pixels[i];
    const float share = texture.share(p);
    cv::Vec3f color = frame.color(p) + kGrain * (1 - share / kContrast) * grains[i];
    if (share > 0) color += share * (texture.color(p) + lights[textured.index(p)] - frame.color(p));
    out.color(p) = ranges[i].with(frame.color(p)).clamp(color);
    out.kind(p) = static_cast<uchar>(Kind::synthesized);
    out.confidence(p) = static_cast<uchar>(std::lround(255 * synthesized_confidence(distance(p), contrast(p))));
  }
  return out;
}

}  // namespace dvi::synthesize
