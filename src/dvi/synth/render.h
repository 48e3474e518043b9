#pragma once

#include "dvi/geometry/camera.h"
#include "dvi/synth/scene.h"
#include "dvi/synth/tracer.h"

namespace dvi::synth {

/// A camera at the time of an exposure.
struct ExposedCamera {
  const Camera& camera;
  SE3 camera_from_world;
  double gain = 1;  ///< factor of all colors
};

/// Renders the image of a camera with and without the movers, antialiased: pixels at edges are traced several times.
SynthFrame render(const StaticWorld& world, std::vector<PlacedMover> movers, const ExposedCamera& exposed);

}  // namespace dvi::synth
