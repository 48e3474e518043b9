#pragma once

#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/synthesize/noise_texture.h"
#include "dvi/synthesize/road_texture.h"

namespace dvi::synthesize {

/// The textures of the unobserved pixels of a drive.
struct Textures {
  RoadTexture road;
  NoiseTexture noise;
};

/// Adds the road texture to interpolated pixels, or noise texture where the road texture is unknown; their kind becomes
/// `synthesized`. Low frequencies remain those of the interpolation, which continues the surroundings of the hole. `classes`
/// are the harmonize::SurfaceClass of the frame's pixels; empty: all unknown.
harmonize::FilledFrame synthesize(const harmonize::FilledFrame& frame, const View& view, const cv::Mat1b& classes,
                                  const Textures& textures);

}  // namespace dvi::synthesize
