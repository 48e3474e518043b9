#include "dvi/depth/depths.h"

namespace dvi::depth {

Depths::Depths(const Views& views, int mask_margin_px, const std::function<DepthMap(std::size_t)>& make)
    : maps(views.size(), make), visibility(views.size(), [depths = maps, masks = views.masks, mask_margin_px](std::size_t i) {
        return visibility_map(*depths[i], *masks[i], mask_margin_px);
      }) {}

}  // namespace dvi::depth
