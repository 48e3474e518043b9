#pragma once

#include <optional>

#include "dvi/synth/solid.h"
#include "dvi/synth/street_ground.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// An infinitely distant panorama with a gradient and clouds.
class Sky {
 public:
  Sky() = default;
  Sky(const SynthOptions& options, const Noise& noise);
  cv::Vec3f shade(const Ray& ray, double pixel_share = 1) const;

 private:
  std::optional<Texture> panorama_;
};

/// All static parts of the world on one day, in world axes. A room has neither ground nor sky, since it is closed.
struct StaticWorld {
  StaticWorld(const SynthOptions& options, const Noise& noise);

  Street street;
  Light light;
  Solid solid;
  Ground ground;
  Sky sky;
};

}  // namespace dvi::synth
