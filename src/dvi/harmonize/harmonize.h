#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "dvi/core/named.h"
#include "dvi/core/options.h"
#include "dvi/depth/target.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/illumination_change.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// The treatment of unobserved pixels.
enum class Unobserved : std::uint8_t { synthesize, interpolate, leave };
constexpr auto names_of(Unobserved) {
  return std::array{std::pair{Unobserved::synthesize, "synthesize"}, std::pair{Unobserved::interpolate, "interpolate"},
                    std::pair{Unobserved::leave, "leave"}};
}

/// Options of harmonize(); describe() documents each field.
struct HarmonizeOptions {
  bool poisson = true;
  bool seam_gradients = true;
  bool robust_boundary = true;
  bool within_range = true;
  bool unobserved_last = true;
  double unobserved_vertical = 0.1;
  Unobserved unobserved = Unobserved::synthesize;
  bool illumination_change = true;
  bool surface_classes = true;

  void describe(OptionTable& table) {
    table.section("harmonize");
    table.flags(true);
    table.add("unobserved", unobserved,
              "Unobserved pixels: synthesize (from patches of the same surface elsewhere in the image, kind 4), "
              "interpolate (kind 3), or leave (black, kind 5).");
    table.flags(false);
    table.developer();
    table.add("poisson", poisson, "Blend copies seamlessly into their surroundings (eq. 5); false copies colors unchanged.");
    table.add("seam_gradients", seam_gradients,
              "Between pixels of different source frames, use the gradient in the source frames; false: 0, as published.");
    table.add("illumination_change", illumination_change,
              "Adapt copies of other drives to the illumination of the target by the orientation of surfaces.");
    table.add(
        "robust_boundary", robust_boundary,
        "Keep copies near their own colors where the boundary of the hole is inconsistent; false: follow the boundary, as "
        "published.");
    table.add("within_range", within_range,
              "Limit blended copies to the colors around the hole and of the copies; false: no limits, as published.");
    table.add("unobserved_last", unobserved_last,
              "Interpolate unobserved pixels after the copies are solved; false: together, as published (colors bleed).");
    table.add("surface_classes", surface_classes,
              "Interpolate unobserved ground from ground, and upright surfaces from upright surfaces; false: from all sides.");
    table.add("unobserved_vertical", unobserved_vertical, {0.001, 1},
              "Smoothness along columns relative to rows for unobserved pixels; 1: a membrane.");
  }
};

/// Further inputs of harmonize(), all of them optional.
struct HarmonizeInput {
  IlluminationChange illumination{};  ///< The result of compare_illumination().
  sample::Candidates known{};         ///< Candidates of sample::sample_known(), by whose errors confidence is calibrated.
  cv::Mat1b classes{};                ///< SurfaceClass of each pixel, by classify_surfaces(); empty: all unknown.
  /// The ground, along which colors of the road continue; none: they do not.
  const ground::RoadGround* ground = nullptr;
};

/// Computes the colors of the hole from its candidates by a Poisson equation (section 3.4 of the paper, eq. 5). The surrounding
/// image is the Dirichlet boundary; the boundary at the image's border is Neumann. The guidance is the gradient of the copies;
/// between pixels with different sources, the mean of the gradients in both. Unobserved pixels have guidance 0 and are
/// interpolated after the copies: the sky, the ground, then all others, each from pixels of its class.
FilledFrame harmonize(const depth::Target& target, const sample::Candidates& candidates, const HarmonizeInput& input,
                      const HarmonizeOptions& options);

}  // namespace dvi::harmonize
