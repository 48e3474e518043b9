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

/// The color of the road at a pixel.
struct RoadColor {
  cv::Vec3f color;     ///< BGR, in the illumination of the view.
  float extent_m = 0;  ///< Extent of the ground that the pixel covers; 0: the color is unknown.
};

/// The texture of the ground along the road, read from all frames of the drive and completed where no frame shows it. All
/// frames use the same texture.
class RoadTexture {
 public:
  RoadTexture(const ground::RoadGround& ground, const Views& views, const Lazy<depth::VisibilityMap>& visibility);

  /// Returns the color of the ground at each pixel of a region of a view. It is unknown for pixels of the class
  /// harmonize::SurfaceClass::upright, and if the ray does not intersect the known ground.
  std::vector<RoadColor> look_up(const View& view, const Region& region, const cv::Mat1b& classes) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace dvi::synthesize
