#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::synthesize {

/// The surfaces that the pixels of an image show. They determine which exemplars a pixel may have.
struct SurfaceGuide {
  cv::Mat1b group;  ///< Exemplars are in the same group; 0: the pixel is neither completed nor an exemplar.
  cv::Mat2f
      ground;  ///< Position on the plane of the ground, along the road and to the left, in meters; NaN: not on the ground.

  /// Returns the guide of a part of the image, which shares its memory.
  SurfaceGuide of(const cv::Rect& box) const { return {group(box), ground(box)}; }
};

/// A part of the unknown pixels of an image, which is completed on its own.
struct UnknownPart {
  cv::Rect box;       ///< The part with the surroundings in which exemplars are searched.
  cv::Mat1b unknown;  ///< Its pixels in the box, 255 each.
};

/// Divides unknown pixels into parts that are far from each other. Each has enough pixels of `usable` around it.
std::vector<UnknownPart> divide_for_search(const cv::Mat1b& unknown, const cv::Mat1b& usable);

/// The pixels to complete, and those that may be exemplars, 255 each.
struct ExemplarMasks {
  cv::Mat1b unknown, usable;
};

/// Completes unknown pixels by patches of known ones: PatchMatch (C. Barnes et al., SIGGRAPH 2009) on an image pyramid, with
/// votes of all patches that cover a pixel (Y. Wexler et al., Space-time completion of video, PAMI 2007) and a penalty for
/// exemplars that are used more often than others (A. Kaspar et al., Self tuning texture optimization, Eurographics 2015).
/// Patches of the ground are transformed by the perspective of its plane, so that textures are continued along the road.
///
/// `color` has initial values in the unknown pixels, and is modified there only. Pixels without any exemplar keep their values.
void complete_from_exemplars(cv::Mat3f& color, const ExemplarMasks& masks, const SurfaceGuide& guide, std::uint64_t seed);

}  // namespace dvi::synthesize
