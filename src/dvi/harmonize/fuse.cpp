#include "dvi/harmonize/fuse.h"

#include <algorithm>
#include <map>

#include "dvi/drive/vignetting.h"
#include "dvi/drive/warp.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/image/saturation.h"

namespace dvi::harmonize {
namespace {

/// Parameters of the fusion of sources.
struct FuseParams {
  /// Difference between two pixels of the same surface: three sigmas, where each pixel has a sigma of 2.5 gray levels.
  float max_difference_levels = 3 * 1.41421F * 2.5F;
  float saturated_weight = 0.01F;  ///< Relative weight of saturated colors.
  int bleed_px = 1;                ///< Distance from sky at which colors are mixed with it.
};
constexpr FuseParams kFuse;

bool agree(const SourceColor& a, const SourceColor& b) {
  return max_difference(a.color, b.color) <= kFuse.max_difference_levels;
}

std::size_t find_leading(std::span<const SourceColor> colors) {
  float all = 0;
  for (const SourceColor& s : colors) all += s.weight;
  for (std::size_t k = 0; k < colors.size(); ++k) {
    float support = 0;
    for (const SourceColor& s : colors) support += agree(s, colors[k]) ? s.weight : 0;
    if (colors[k].weight > 0 && 2 * support >= all) return k;
  }
  return static_cast<std::size_t>(
      std::max_element(colors.begin(), colors.end(),
                       [](const SourceColor& a, const SourceColor& b) { return a.weight < b.weight; }) -
      colors.begin());
}

}  // namespace

Agreement find_agreement(std::span<const SourceColor> colors) {
  Agreement out;
  out.leading = find_leading(colors);
  const SourceColor& first = colors[out.leading];
  float weight = 0, others = 0;
  for (const SourceColor& s : colors) {
    if (s.weight <= 0) continue;
    if (&s != &first) {
      out.spread += mean_difference(s.color, first.color);
      ++others;
    }
    if (!agree(s, first)) continue;
    out.color += s.weight * s.color;
    weight += s.weight;
    ++out.sources;
  }
  if (weight > 0) out.color /= weight;
  if (others > 0) out.spread /= others;
  return out;
}

Fused fuse(const depth::Target& target, const sample::Candidates& candidates, const IlluminationChange& illumination) {
  const Views& views = target.views;
  const std::size_t pixels = candidates.hole.size(), ranks = candidates.extra_per_pixel + 1;
  std::vector<SourceColor> colors(pixels * ranks);
  std::vector<cv::Vec2b> footprints(pixels * ranks, cv::Vec2b(1, 1));
  const auto candidate = [&](std::size_t slot) -> const sample::Candidate& {
    const std::size_t pixel = slot / ranks, rank = slot % ranks;
    return rank == 0 ? candidates.leading[pixel] : candidates.others(pixel)[rank - 1];
  };
  cv::Mat1b sky(candidates.hole.index.size(), uchar{0});
  std::map<int, std::vector<std::size_t>> of_view;
  for (std::size_t slot = 0; slot < colors.size(); ++slot)
    if (candidate(slot).found()) of_view[candidate(slot).view].push_back(slot);
  for (const auto& [view, slots] : of_view) {
    const auto image = views.images[view];
    const auto mask = views.masks[view];
    const bool is_other_drive = views[view].drive != target.view().drive;
    for (const std::size_t slot : slots) {
      const sample::Candidate& from = candidate(slot);
      if (is_other_drive && !illumination.is_consistent(views[view], slot / ranks)) continue;
      if (can_sample(*mask, from.position, from.footprint)) footprints[slot] = from.footprint;
      const cv::Vec3f color = box_mean(*image, from.position, footprints[slot]);
      const float shade = vignetting_to(target.view(), candidates.hole.pixels[slot / ranks], views[view], from.position);
      const cv::Vec3f lit = apply_vignetting(color, shade).mul(illumination.gain_to(target.view(), views[view], slot / ranks));
      // It is brighter than any surface of the target, so the gains, which were estimated from surfaces, do not apply to it.
      if (is_other_drive && std::max({lit[0], lit[1], lit[2]}) > illumination.max_surface_level + kFuse.max_difference_levels) {
        sky(candidates.hole.pixels[slot / ranks]) = 255;
        continue;
      }
      colors[slot] = {lit, from.score * (is_saturated(color) ? kFuse.saturated_weight : 1)};
    }
  }
  sky = grown(sky, kFuse.bleed_px);
  for (std::size_t slot = 0; slot < colors.size(); ++slot)
    if (sky(candidates.hole.pixels[slot / ranks]) != 0 && candidate(slot).found() &&
        views[candidate(slot).view].drive != target.view().drive)
      colors[slot].weight = 0;
  Fused out{{candidates.hole, std::vector<sample::Candidate>(pixels)},
            std::vector<cv::Vec3f>(pixels),
            std::vector<std::uint8_t>(pixels),
            std::vector<float>(pixels),
            sky};
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::span<const SourceColor> of_pixel{&colors[i * ranks], ranks};
    if (std::none_of(of_pixel.begin(), of_pixel.end(), [](const SourceColor& s) { return s.weight > 0; })) continue;
    const Agreement agreed = find_agreement(of_pixel);
    const std::size_t slot = i * ranks + agreed.leading;
    out.candidates.leading[i] = candidate(slot);
    out.candidates.leading[i].footprint = footprints[slot];
    out.color[i] = agreed.color;
    out.sources[i] = agreed.sources;
    out.spread[i] = agreed.spread;
  }
  return out;
}

}  // namespace dvi::harmonize
