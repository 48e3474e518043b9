#pragma once

#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/lazy.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"
#include "dvi/ground/road_ground.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {

/// What a surface shows at a pixel.
struct SurfaceColor {
  cv::Vec3f color;  ///< BGR, in the light of the view
  float span = 0;   ///< meters of the surface that the pixel covers; 0: nothing is known
};

/// What the drive shows of the ground along the road, completed where no frame saw it. It is made in pieces, on demand, so that
/// every frame looks up the same.
class Surfaces {
 public:
  Surfaces(const ground::RoadGround& ground, const Views& views, const Lazy<depth::VisibilityMap>& visibility);

  /// What it shows at the pixels of a region of a view: where the ray meets the ground, unless something stands there by the
  /// harmonize::SurfaceClass of the pixel.
  std::vector<SurfaceColor> look_up(const View& view, const Region& region, const cv::Mat1b& classes) const;

 private:
  struct Pieces;
  std::shared_ptr<const Pieces> pieces_;
};

}  // namespace dvi::synthesize
