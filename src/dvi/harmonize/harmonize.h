#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "dvi/core/named.h"
#include "dvi/core/options.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/day_light.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// What becomes of pixels that no frame saw.
enum class NeverSeen : std::uint8_t { synthesise, interpolate, leave };
constexpr auto names_of(NeverSeen) {
  return std::array{std::pair{NeverSeen::synthesise, "synthesise"}, std::pair{NeverSeen::interpolate, "interpolate"},
                    std::pair{NeverSeen::leave, "leave"}};
}

struct HarmonizeOptions {
  bool poisson = true;
  bool seam_gradients = true;
  bool within_range = true;
  bool never_seen_last = true;
  double never_seen_vertical = 0.1;
  NeverSeen never_seen = NeverSeen::synthesise;
  bool day_light = true;

  void describe(OptionTable& table) {
    table.section("harmonize");
    table.add("never_seen", never_seen,
              "Pixels that no frame saw: synthesise (interpolated, with the texture of the ground or grain, kind 4), "
              "interpolate (kind 3), or leave (black, kind 5).");
    table.developer();
    table.add("poisson", poisson, "Blend copies seamlessly into their surroundings (eq. 5); false copies colours unchanged.");
    table.add("seam_gradients", seam_gradients,
              "Between pixels of different source frames, use the gradient in the source frames; false: 0, as published.");
    table.add("day_light", day_light,
              "Bring copies of other drives into the target's light by the direction that surfaces face.");
    table.add("within_range", within_range,
              "Keep blended copies within the colours round the hole and of the copies; false: as solved, as published.");
    table.add("never_seen_last", never_seen_last,
              "Interpolate never-seen pixels after the copies are solved; false: together, as published (bleeds).");
    table.add("never_seen_vertical", never_seen_vertical, {0.001, 1},
              "Smoothness along columns relative to rows for never-seen pixels; 1: a membrane.");
  }
  void check() const { check_ranges(*this); }
};

/// Colours the hole from its candidates (eq. 5): per hole a Poisson equation with the surrounding image as Dirichlet
/// boundary (Neumann at the image's border). Its guidance is the gradient of the copies, between pixels of different sources
/// what these show there, and 0 at pixels without a source, which are interpolated once the copies stand. `known`, from
/// sample::sample_known, tells how far copies are off in this frame, and their confidence follows it.
FilledFrame harmonize(const sample::Candidates& candidates, const Views& views, std::size_t target,
                      const depth::DepthMap& depth, const DayLight& light, const HarmonizeOptions& options,
                      const sample::Candidates& known = {});

}  // namespace dvi::harmonize
