#pragma once

#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/synthesize/grain.h"
#include "dvi/synthesize/surfaces.h"

namespace dvi::synthesize {

/// What the unobserved pixels of a drive are given the texture of.
struct Textures {
  Surfaces surfaces;
  Grain grain;
};

/// Gives interpolated pixels the texture of the surfaces that lie there, and grain where nothing is known of these: kind
/// synthesized. The interpolation keeps the low frequencies, which continue what surrounds the hole. `classes` are
/// the harmonize::SurfaceClass of the frame's pixels; empty: all unknown.
harmonize::FilledFrame synthesize(const harmonize::FilledFrame& frame, const View& view, const cv::Mat1b& classes,
                                  const Textures& textures);

}  // namespace dvi::synthesize
