#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {

/// Noise for pixels of which nothing is known but what surrounds them: in each octave from 2 to 16 px of wavelength as strong
/// as what was known or copied beside them (band by band, as Heeger and Bergen, 1995, match textures). It is painted on
/// panoramas round places every 10 m of the target's way, so that it stays on what it lies on while the camera comes nearer.
class Grain {
 public:
  explicit Grain(const Views& views);

  /// To be added to the colors of a region, as region.pixels, BGR. `view` is one of the target's; `classes` are its
  /// harmonize::SurfaceClass: the ground has the grain of ground.
  std::vector<cv::Vec3f> at(const harmonize::FilledFrame& frame, const Region& region, const View& view,
                            const cv::Mat1b& classes) const;

 private:
  std::vector<Eigen::Vector3d> centers_;  // of the target's views
  std::vector<double> way_;               // as centers_, in steps from one panorama to the next
  std::vector<Eigen::Vector3d> places_;   // of the panoramas; the first lies a step before the first view
};

}  // namespace dvi::synthesize
