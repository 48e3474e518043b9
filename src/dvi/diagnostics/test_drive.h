#pragma once

#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "dvi/diagnostics/scan_tracks.h"
#include "dvi/synth/scene.h"

namespace dvi::diagnostics {

/// Returns a small recording of the synthetic street. Each is rendered once per process.
inline Drive make_test_drive(int seed, double turn_deg, double speed_mps = 8) {
  static std::map<std::tuple<int, double, double>, Drive> made;
  const auto [place, is_new] = made.try_emplace({seed, turn_deg, speed_mps});
  if (!is_new) return place->second;
  synth::SynthOptions options;
  options.frames = 14, options.width = 640, options.height = 360, options.beams = 48, options.columns = 900;
  options.seed = seed, options.turn_deg = turn_deg, options.speed_mps = speed_mps;
  return place->second = synth::drive_of(std::make_shared<synth::Scene>(options));
}

/// Returns the true motion in place of that of odometry.
inline std::vector<ScanTrack> make_true_tracks(const Drive& drive) { return {{0, drive.scan_headers.size(), drive.poses}}; }

}  // namespace dvi::diagnostics
