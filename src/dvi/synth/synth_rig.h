#pragma once

#include <vector>

#include "dvi/synth/scene.h"

namespace dvi::synth {

/// Makes the lens that all cameras of the scene have.
Camera make_lens(const SynthOptions& options);
/// Makes the cameras of a car, of which the first one is "front", or the hand-held camera of a room, "color".
std::vector<SceneCamera> make_rig(const SynthOptions& options);

}  // namespace dvi::synth
