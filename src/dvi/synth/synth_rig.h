#pragma once

#include <vector>

#include "dvi/synth/scene.h"

namespace dvi::synth {

/// The lens that all cameras of the scene share.
Camera make_lens(const SynthOptions& options);
/// The cameras of a car, "front" first; of a room the one in the hand, "color".
std::vector<SceneCamera> make_rig(const SynthOptions& options);

}  // namespace dvi::synth
