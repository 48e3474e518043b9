#include "dvi/harmonize/fuse.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "dvi/drive/vignetting.h"
#include "dvi/drive/warp.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/image/saturation.h"

namespace dvi::harmonize {
namespace {

constexpr float kNoise = 2.5F;                    // gray levels of a camera's pixel, one sigma
constexpr float kDiffer = 3 * 1.41421F * kNoise;  // two pixels of the same thing differ by no more
constexpr float kSaturatedTrust = 0.01F;
constexpr int kBleeds = 1;  // px from what is too bright for the target's light, what it is in front of is mixed with it

bool agree(const SourceColor& a, const SourceColor& b) { return most_different(a.color, b.color) <= kDiffer; }

std::size_t leading_of(std::span<const SourceColor> shown) {
  float all = 0;
  for (const SourceColor& s : shown) all += s.trust;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    float support = 0;
    for (const SourceColor& s : shown) support += agree(s, shown[k]) ? s.trust : 0;
    if (shown[k].trust > 0 && 2 * support >= all) return k;
  }
  return static_cast<std::size_t>(
      std::max_element(shown.begin(), shown.end(),
                       [](const SourceColor& a, const SourceColor& b) { return a.trust < b.trust; }) -
      shown.begin());
}

}  // namespace

float most_different(const cv::Vec3f& a, const cv::Vec3f& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

float mean_difference(const cv::Vec3f& a, const cv::Vec3f& b) {
  return (std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2])) / 3;
}

Agreement agreement(std::span<const SourceColor> shown) {
  Agreement out;
  out.leading = leading_of(shown);
  const SourceColor& first = shown[out.leading];
  float weight = 0, others = 0;
  for (const SourceColor& s : shown) {
    if (s.trust <= 0) continue;
    if (&s != &first) {
      out.spread += mean_difference(s.color, first.color);
      ++others;
    }
    if (!agree(s, first)) continue;
    out.color += s.trust * s.color;
    weight += s.trust;
    ++out.sources;
  }
  if (weight > 0) out.color /= weight;
  if (others > 0) out.spread /= others;
  return out;
}

Fused fuse(const depth::Target& target, const sample::Candidates& candidates, const DayLight& light) {
  const Views& views = target.views;
  const std::size_t pixels = candidates.hole.size(), ranks = candidates.extra_per_pixel + 1;
  std::vector<SourceColor> shown(pixels * ranks);
  std::vector<cv::Vec2b> footprints(pixels * ranks, cv::Vec2b(1, 1));
  const auto candidate = [&](std::size_t slot) -> const sample::Candidate& {
    const std::size_t pixel = slot / ranks, rank = slot % ranks;
    return rank == 0 ? candidates.leading[pixel] : candidates.others(pixel)[rank - 1];
  };
  cv::Mat1b sky(candidates.hole.index.size(), uchar{0});
  std::map<int, std::vector<std::size_t>> of_view;
  for (std::size_t slot = 0; slot < shown.size(); ++slot)
    if (candidate(slot).found()) of_view[candidate(slot).view].push_back(slot);
  for (const auto& [view, slots] : of_view) {
    const auto image = views.images[view];
    const auto mask = views.masks[view];
    const bool other_day = views[view].drive != target.view().drive;
    for (const std::size_t slot : slots) {
      const sample::Candidate& from = candidate(slot);
      if (other_day && !light.agrees(views[view], slot / ranks)) continue;
      if (can_sample(*mask, from.position, from.footprint)) footprints[slot] = from.footprint;
      const cv::Vec3f color = box_mean(*image, from.position, footprints[slot]);
      const float shade = vignetting_to(target.view(), candidates.hole.pixels[slot / ranks], views[view], from.position);
      const cv::Vec3f lit = vignetted(color, shade).mul(light.gain_to(target.view(), views[view], slot / ranks));
      // Brighter than any surface of the target, beyond noise: it is not lit as those are that the gains were found from.
      if (other_day && std::max({lit[0], lit[1], lit[2]}) > light.brightest + kDiffer) {
        sky(candidates.hole.pixels[slot / ranks]) = 255;
        continue;
      }
      shown[slot] = {lit, from.score * (is_saturated(color) ? kSaturatedTrust : 1)};
    }
  }
  sky = grown(sky, kBleeds);
  for (std::size_t slot = 0; slot < shown.size(); ++slot)
    if (sky(candidates.hole.pixels[slot / ranks]) != 0 && candidate(slot).found() &&
        views[candidate(slot).view].drive != target.view().drive)
      shown[slot].trust = 0;
  Fused out{{candidates.hole, std::vector<sample::Candidate>(pixels)},
            std::vector<cv::Vec3f>(pixels),
            std::vector<std::uint8_t>(pixels),
            std::vector<float>(pixels),
            sky};
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::span<const SourceColor> of_pixel{&shown[i * ranks], ranks};
    if (std::none_of(of_pixel.begin(), of_pixel.end(), [](const SourceColor& s) { return s.trust > 0; })) continue;
    const Agreement agreed = agreement(of_pixel);
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
