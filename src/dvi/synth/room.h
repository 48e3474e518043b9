#pragma once

#include <vector>

#include "dvi/geometry/se3.h"
#include "dvi/synth/solid.h"
#include "dvi/synth/traffic.h"

namespace dvi::synth {

/// A furnished room, 7 x 5.4 x 2.6 m round the origin, whose floor is z = 0.
Solid make_room(const SynthOptions& options, const Noise& noise);
Light room_light(int day);
/// The camera in a hand that moves along the room's short side and looks across it; axes x forward, y left, z up.
SE3 world_from_hand(const SynthOptions& options, double time);
/// A person who walks to and fro through the middle of the room.
std::vector<Mover> make_visitors(const SynthOptions& options, const Noise& noise);

/// What a depth camera measures where the true depth is `depth` (meters, 0 nothing): noise that grows with the square of the
/// depth and is `noise_5m` meters at 5 m (Nguyen et al., 3DIMPVT 2012), and nothing beside a jump in depth. Millimeters.
cv::Mat1w measured_depth(const cv::Mat1f& depth, double noise_5m, Random random);

}  // namespace dvi::synth
