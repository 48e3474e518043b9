#pragma once

#include "dvi/geometry/camera.h"
#include "dvi/synth/scene.h"
#include "dvi/synth/tracer.h"

namespace dvi::synth {

/// Renders the image of a camera with and without the movers, antialiased: pixels at edges are traced several times.
SynthFrame render(const StaticWorld& world, std::vector<PlacedMover> movers, const Camera& camera, const SE3& camera_from_world,
                  double gain);

}  // namespace dvi::synth
