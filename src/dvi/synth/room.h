#pragma once

#include <vector>

#include "dvi/geometry/se3.h"
#include "dvi/synth/solid.h"
#include "dvi/synth/traffic.h"

namespace dvi::synth {

/// Makes a furnished room of 7 x 5.4 x 2.6 m around the origin, whose floor is z = 0.
Solid make_room(const SynthOptions& options, const Noise& noise);
Light make_room_light(int day);
/// Returns the pose of a hand-held camera that moves along the room's short side and looks across it; axes x forward, y left, z
/// up.
SE3 world_from_hand(const SynthOptions& options, double time);
/// Makes a person who walks back and forth through the middle of the room.
std::vector<Mover> make_visitors(const SynthOptions& options, const Noise& noise);

/// Simulates a depth camera. `depth` is the true depth in meters, 0 for none. The noise grows with the square of the depth and
/// is `noise_5m` meters at 5 m (Nguyen et al., 3DIMPVT 2012); pixels beside a jump in depth have no value. Returns millimeters.
cv::Mat1w simulate_depth(const cv::Mat1f& depth, double noise_5m, Random random);

}  // namespace dvi::synth
