#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "dvi/core/named.h"
#include "dvi/core/options.h"
#include "dvi/depth/target.h"
#include "dvi/harmonize/day_light.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// What becomes of pixels that no frame saw.
enum class Unobserved : std::uint8_t { synthesize, interpolate, leave };
constexpr auto names_of(Unobserved) {
  return std::array{std::pair{Unobserved::synthesize, "synthesize"}, std::pair{Unobserved::interpolate, "interpolate"},
                    std::pair{Unobserved::leave, "leave"}};
}

struct HarmonizeOptions {
  bool poisson = true;
  bool seam_gradients = true;
  bool robust_rim = true;
  bool within_range = true;
  bool unobserved_last = true;
  double unobserved_vertical = 0.1;
  Unobserved unobserved = Unobserved::synthesize;
  bool day_light = true;
  bool surface_classes = true;

  void describe(OptionTable& table) {
    table.section("harmonize");
    table.flags(true);
    table.add("unobserved", unobserved,
              "Determines how unobserved pixels are filled: synthesize (interpolated, with the texture of the ground or noise, "
              "kind 4), interpolate (kind 3), or leave (black, kind 5).");
    table.flags(false);
    table.developer();
    table.add("poisson", poisson, "Blend copies seamlessly into their surroundings (eq. 5); false copies colors unchanged.");
    table.add("seam_gradients", seam_gradients,
              "Between pixels of different source frames, use the gradient in the source frames; false: 0, as published.");
    table.add("day_light", day_light,
              "Bring copies of other drives into the target's light by the direction that surfaces face.");
    table.add(
        "robust_rim", robust_rim,
        "Hold copies near their own colors where they contradict the rim of the hole in themselves; false: the rim has the "
        "last word, as published.");
    table.add("within_range", within_range,
              "Keep blended copies within the colors round the hole and of the copies; false: as solved, as published.");
    table.add("unobserved_last", unobserved_last,
              "Interpolate unobserved pixels after the copies are solved; false: together, as published (bleeds).");
    table.add("surface_classes", surface_classes,
              "Interpolate unobserved ground from ground, and what stands upright from what does; false: from all round.");
    table.add("unobserved_vertical", unobserved_vertical, {0.001, 1},
              "Smoothness along columns relative to rows for unobserved pixels; 1: a membrane.");
  }
};

/// What is known round a hole, beside the image.
struct HarmonizeInput {
  DayLight light{};            ///< of other drives, by compare_days()
  sample::Candidates known{};  ///< of sample::sample_known: how far copies are off in this frame; their confidence follows it
  cv::Mat1b classes{};         ///< SurfaceClass, by classify_surfaces(); empty: all unknown
};

/// Colors the hole from its candidates (eq. 5): per hole a Poisson equation with the surrounding image as Dirichlet
/// boundary (Neumann at the image's border). Its guidance is the gradient of the copies, between pixels of different sources
/// what these show there, and 0 at pixels without a source, which are interpolated once the copies stand: the sky, then the
/// ground, then what stands on it, each from its like.
FilledFrame harmonize(const depth::Target& target, const sample::Candidates& candidates, const HarmonizeInput& input,
                      const HarmonizeOptions& options);

}  // namespace dvi::harmonize
