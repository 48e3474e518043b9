#include "dvi/synthesize/synthesize.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/blur.h"
#include "dvi/image/neighbors.h"
#include "dvi/image/poisson.h"
#include "dvi/image/region.h"
#include "dvi/synthesize/noise_texture.h"
#include "dvi/synthesize/road_texture.h"
#include "dvi/synthesize/surrounding_ranges.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

/// Parameters of the synthesis.
struct SynthesisParams {
  int margin_px = 6;           ///< Width of the area around synthesized pixels where texture and frame are compared.
  float road_contrast = 0.6F;  ///< Share of the contrast of the road texture: synthesized pixels should not attract attention.
  float noise_contrast = 0.75F;  ///< Share of the contrast of the noise texture.
  float fine_extent_m = 0.5F;    ///< Extent of a pixel on the ground up to which the road texture has its full contrast.
  float max_extent_m = 1;        ///< Extent from which on it is not used, because errors of height and offsets exceed a pixel.
  double relight_sigma_px = 10;  ///< Sigma of the means by which the texture is adapted to the illumination of the frame.
  float dark_levels = 4;         ///< Added to these means, in gray levels.
  float max_relight = 2;         ///< Largest factor of that adaptation.
  /// Smoothing of differences along the margin; a texture that is displaced there must not spread.
  double margin_sigma_px = 2;
  float screening_weight = 1e-2F;  ///< The interpolation determines the brightness beyond 1 / sqrt(weight), 10 px.
};
constexpr SynthesisParams kSynthesis;

/// Parameters of the fine contrast of the surroundings, which confidence depends on.
struct FineContrastParams {
  double fine_sigma_px = 2;    ///< Details smaller than this are fine.
  double mean_sigma_px = 20;   ///< Size of the surroundings.
  float prior_weight = 1e-3F;  ///< Weight of the prior contrast, relative to a known pixel.
  float prior_levels = 8;      ///< Contrast where no known pixel is near.
};
constexpr FineContrastParams kFineContrast;

/// Returns the share of the road texture's contrast that is used for a pixel, by its extent on the ground.
float road_share(float extent_m) {
  constexpr float kFine = kSynthesis.fine_extent_m, kMax = kSynthesis.max_extent_m;
  return kSynthesis.road_contrast * std::clamp((kMax - extent_m) / (kMax - kFine), 0.0F, 1.0F);
}

/// Measures the fine contrast of known and copied pixels near each pixel, in gray levels.
cv::Mat1f measure_fine_contrast(const harmonize::FilledFrame& frame) {
  cv::Mat1f gray, smooth;
  cv::transform(frame.color, gray, cv::Matx13f::all(1.0F / 3));
  cv::GaussianBlur(gray, smooth, {}, kFineContrast.fine_sigma_px);
  const cv::Mat1b known(frame.kind < static_cast<uchar>(Kind::interpolated));
  cv::Mat1f fine(cv::abs(gray - smooth)), weight(gray.size(), 0.0F);
  fine.setTo(0, ~known);
  weight.setTo(1, known);
  constexpr double kSigma = kFineContrast.mean_sigma_px;
  return cv::Mat1f((blurred(fine, kSigma) + kFineContrast.prior_weight * kFineContrast.prior_levels) /
                   (blurred(weight, kSigma) + kFineContrast.prior_weight));
}

/// Returns the probability that a synthesized pixel is within 10 gray levels of the truth, by its distance in pixels to the
/// nearest known or copied pixel, and by the contrast there (docs/algorithms/confidence.md).
double confidence_of_synthesis(float distance_px, float contrast) {
  return 1 / (1 + std::exp(-3.83 - 2.83 * std::exp(-distance_px / 9) + 2.87 * std::log1p(contrast)));
}

/// The road texture in a frame.
struct FrameTexture {
  cv::Mat3f color, difference;  ///< Its color; the color of the frame minus it.
  cv::Mat1f share;              ///< The result of road_share().
  cv::Mat1b known;              ///< 255 where it is known.
};

/// Adapts the texture to the illumination of the frame around it. The factor applies to its contrast, too, so that sunlit
/// patterns are weaker in shadow.
void relight(FrameTexture& texture, const cv::Mat3f& frame) {
  constexpr double kSigma = kSynthesis.relight_sigma_px;
  cv::Mat3f of_frame(frame.size(), cv::Vec3f());
  frame.copyTo(of_frame, texture.known);
  cv::Mat1f known(frame.size(), 0.0F);
  known.setTo(1, texture.known);
  const cv::Mat3f shown = blurred(texture.color, kSigma), lit = blurred(of_frame, kSigma);
  const cv::Mat1f weight = blurred(known, kSigma);
  for (const cv::Point p : Region(texture.known).pixels)
    for (int c = 0; c < 3; ++c) {
      const float dark = kSynthesis.dark_levels * weight(p);
      texture.color(p)[c] *= std::min((lit(p)[c] + dark) / (shown(p)[c] + dark), kSynthesis.max_relight);
      texture.difference(p)[c] = frame(p)[c] - texture.color(p)[c];
    }
}

/// Looks up the road texture at the pixels of `wanted` and around them.
FrameTexture look_up_road(const harmonize::FilledFrame& frame, const cv::Mat1b& wanted,
                          const std::function<std::vector<RoadColor>(const Region&)>& look_up) {
  const Region region(grown(wanted, kSynthesis.margin_px));
  const std::vector<RoadColor> found = look_up(region);
  const cv::Size size = wanted.size();
  FrameTexture out{cv::Mat3f(size, cv::Vec3f()), cv::Mat3f(size, cv::Vec3f()), cv::Mat1f(size, 0.0F),
                   cv::Mat1b(size, uchar{0})};
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point p = region.pixels[i];
    if (!(found[i].extent_m > 0) || frame.kind(p) == static_cast<uchar>(Kind::empty)) continue;
    out.color(p) = found[i].color;
    out.share(p) = road_share(found[i].extent_m);
    out.known(p) = 255;
  }
  relight(out, frame.color);
  return out;
}

/// Smooths the difference of frame and texture along the margin around `wanted`.
cv::Mat3f smooth_margin(const FrameTexture& texture, const cv::Mat1b& wanted) {
  constexpr double kSigma = kSynthesis.margin_sigma_px;
  const cv::Mat1b margin(texture.known & ~wanted);
  cv::Mat3f sum(margin.size(), cv::Vec3f());
  cv::Mat1f weight(margin.size(), 0.0F);
  texture.difference.copyTo(sum, margin);
  weight.setTo(1, margin);
  cv::GaussianBlur(sum, sum, {}, kSigma);
  cv::GaussianBlur(weight, weight, {}, kSigma);
  for (const cv::Point p : Region(margin).pixels) sum(p) /= weight(p);
  return sum;
}

/// Solves a screened Poisson equation for the colors that are added to the texture. At the boundary they are the difference of
/// the frame to the texture, farther inside the mean difference of the interpolation to it.
std::vector<cv::Vec3f> solve_offsets(const FrameTexture& texture, const cv::Mat1b& wanted, const Region& region) {
  const cv::Mat3f boundary = smooth_margin(texture, wanted);
  PoissonSystem system{region, {}, {}, 1};
  std::vector<cv::Vec3f> x;
  const cv::Rect inside({}, wanted.size());
  for (const cv::Point p : region.pixels) {
    float diagonal = kSynthesis.screening_weight;
    cv::Vec3f right = kSynthesis.screening_weight * texture.difference(p);
    for (const cv::Point q : four_neighbors(p)) {
      if (!inside.contains(q) || texture.known(q) == 0) continue;
      diagonal += 1;
      if (wanted(q) == 0) right += boundary(q);
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
  const FrameTexture texture =
      look_up_road(frame, wanted, [&](const Region& region) { return textures.road.look_up(view, region, classes); });
  const Region region(wanted), textured(cv::Mat1b(wanted & texture.known));
  const std::vector<cv::Vec3f> offsets = solve_offsets(texture, wanted, textured),
                               noise = textures.noise.compute(frame, region, view, classes);
  harmonize::FilledFrame out = frame;
  for (cv::Mat* changed : std::initializer_list<cv::Mat*>{&out.color, &out.kind, &out.confidence}) *changed = changed->clone();
  cv::Mat1f distance;
  cv::distanceTransform(cv::Mat1b(frame.kind >= static_cast<uchar>(Kind::interpolated)), distance, cv::DIST_L2,
                        cv::DIST_MASK_PRECISE);
  const cv::Mat1f contrast = measure_fine_contrast(frame);
  const std::vector<ColorRange> ranges = find_surrounding_ranges(frame, region);
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point p = region.pixels[i];
    const float share = texture.share(p);
    cv::Vec3f color = frame.color(p) + kSynthesis.noise_contrast * (1 - share / kSynthesis.road_contrast) * noise[i];
    if (share > 0) color += share * (texture.color(p) + offsets[textured.index(p)] - frame.color(p));
    out.color(p) = ranges[i].with(frame.color(p)).clamp(color);
    out.kind(p) = static_cast<uchar>(Kind::synthesized);
    out.confidence(p) = static_cast<uchar>(std::lround(255 * confidence_of_synthesis(distance(p), contrast(p))));
  }
  return out;
}

}  // namespace dvi::synthesize
