#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "dvi/core/options.h"

namespace dvi::synth {

/// panorama: a camera of the whole sphere, whose images are twice as wide as high.
enum class SynthLens : std::uint8_t { pinhole, fisheye, unified, panorama };
constexpr auto names_of(SynthLens) {
  return std::array{std::pair{SynthLens::pinhole, "pinhole"}, std::pair{SynthLens::fisheye, "fisheye"},
                    std::pair{SynthLens::unified, "unified"}, std::pair{SynthLens::panorama, "panorama"}};
}

/// The options of the street or room and its recording. Two recordings share one street (world coordinates, facades, trees) if
/// seed, frames, speed_mps, rate_hz and turn_deg agree; `day` changes light, parked cars, lane and traffic, `reverse` the
/// direction, `wet` and `changes` the street itself. Two recordings share one room if seed agrees.
struct SynthOptions {
  int frames = 20;
  int width = 960, height = 540;
  int seed = 1;
  int day = 1;
  bool reverse = false;
  double speed_mps = 8;
  double turn_deg = 0;
  bool truck = false;
  bool walker = false;
  bool wet = false, changes = false;
  double stereo_m = 0;
  bool side_cameras = false, six_cameras = false;
  SynthLens lens = SynthLens::pinhole;
  bool room = false;
  int beams = 64, columns = 1800;
  double rate_hz = 10;
  double range_m = 120;
  double exposure_drift = 0;
  double jitter_deg = 0;
  double image_noise = 1.5, range_noise = 0.02;

  void describe(OptionTable& table);
  /// Throws UsageError for the first option out of its range, or for options that do not apply to a room.
  void check() const;

  /// Returns the length of the drive in meters.
  double distance() const { return speed_mps * frames / rate_hz; }
};

}  // namespace dvi::synth
