#pragma once

#include <filesystem>

#include "dvi/core/interrupt.h"
#include "dvi/synth/scene.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// Writes the recording of a synthetic street or room in the `folder` layout, with the exact truth of the first camera
/// ("front", or "color" in a room):
///   truth/NAME.png          the frame without traffic and without noise, with the frame's exposure
///   truth_depth/NAME.png    16-bit, Camera::depth() in meters x 256 of the static scene, 0 sky (255.99 m at most)
///   truth_points/NAME.label uint32 per point of the scan: SynthScan::label; not in a room
///   truth_cameras.txt       NAME, 12 numbers camera_from_world of the true camera, exposure gain
/// and the same of each other camera in truth/CAMERA, truth_depth/CAMERA and truth_cameras_CAMERA.txt. `tick` is called once
/// per frame. Throws UsageError for bad options, and InputError if the folder cannot be written.
void synthesize(const SynthOptions& options, const std::filesystem::path& out, const Tick& tick = {});

}  // namespace dvi::synth
