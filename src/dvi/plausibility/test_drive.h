#pragma once

#include <memory>
#include <vector>

#include "dvi/plausibility/scan_tracks.h"
#include "dvi/synth/scene.h"

namespace dvi::plausibility {

/// A small recording of the synthetic street.
inline Drive test_drive(int seed, double turn_deg, double speed_mps = 8) {
  synth::SynthOptions options;
  options.frames = 14, options.width = 640, options.height = 360, options.beams = 48, options.columns = 900;
  options.seed = seed, options.turn_deg = turn_deg, options.speed_mps = speed_mps;
  return synth::drive_of(std::make_shared<synth::Scene>(options));
}

/// The true motion, in place of the odometry's.
inline std::vector<ScanTrack> true_tracks(const Drive& drive) { return {{0, drive.scan_headers.size(), drive.poses}}; }

}  // namespace dvi::plausibility
