#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {

/// Noise for unobserved pixels. In each octave from 2 to 16 px of wavelength it is as strong as in the known and copied pixels
/// nearby (band by band, as D. Heeger and J. Bergen, Pyramid-based texture analysis/synthesis, SIGGRAPH 1995). It is defined on
/// panoramas around points every 10 m along the target's path, so that it moves with the surfaces as the camera approaches
/// them.
class NoiseTexture {
 public:
  explicit NoiseTexture(const Views& views);

  /// Computes the noise to be added to the colors of a region: one value per region pixel, BGR. `view` is a view of the target.
  /// `classes` are its harmonize::SurfaceClass: noise on the ground is as strong as on known ground.
  std::vector<cv::Vec3f> compute(const harmonize::FilledFrame& frame, const Region& region, const View& view,
                                 const cv::Mat1b& classes) const;

 private:
  std::vector<Eigen::Vector3d> centers_;           // camera centers of the target's views
  std::vector<double> path_steps_;                 // path length to each center, in distances between panoramas
  std::vector<Eigen::Vector3d> panorama_centers_;  // the first one is a step before the first view
};

}  // namespace dvi::synthesize
