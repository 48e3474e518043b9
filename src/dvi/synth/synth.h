#pragma once

#include <filesystem>

#include "dvi/core/interrupt.h"
#include "dvi/synth/scene.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// Writes the recording of a synthetic street in the `folder` layout (camera "front", and "right" where asked for) and its
/// exact truth beside:
///   truth/NAME.png          the frame of camera "front" without traffic and without noise, with the frame's exposure
///   truth_depth/NAME.png    16-bit, depth z in metres x 256 of the static street, 0 sky (255.99 m at most)
///   truth_points/NAME.label uint8 a point of the scan: 1 on traffic
///   truth_cameras.txt       NAME, 12 numbers camera_from_world of the true camera, exposure gain
/// `tick` is called once a frame. UsageError for bad options, InputError where the folder cannot be written.
void synthesise(const SynthOptions& options, const std::filesystem::path& out, const Tick& tick = {});

}  // namespace dvi::synth
