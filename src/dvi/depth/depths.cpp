#include "dvi/depth/depths.h"

#include <algorithm>

#include "dvi/core/threads.h"

namespace dvi::depth {
namespace {

constexpr std::size_t kVisibilityPixels = std::size_t{200} << 20;  // five bytes for four of them

std::size_t kept_visibility(const Camera& camera) {
  const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  return std::max<std::size_t>(16, kVisibilityPixels / pixels);
}

}  // namespace

Depths::Depths(const Views& views, int mask_margin_px, const std::function<DepthMap(std::size_t)>& make)
    : maps(views.size(), static_cast<std::size_t>(thread_count()) + 2, make),
      visibility(views.size(), kept_visibility(views[0].camera),
                 [depths = maps, masks = views.masks, mask_margin_px](std::size_t i) {
                   return visibility_map(*depths[i], *masks[i], mask_margin_px);
                 }) {}

}  // namespace dvi::depth
