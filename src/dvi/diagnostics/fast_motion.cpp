#include "dvi/diagnostics/fast_motion.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/core/text.h"

namespace dvi::diagnostics {
namespace {

/// The rotation speed in radians per second at a time; 0 if poses are missing.
double compute_turn_rad_s(const Trajectory& world_from_lidar, std::int64_t time_ns) {
  constexpr std::int64_t kHalfNs = 15'000'000;
  const auto before = world_from_lidar.at(time_ns - kHalfNs), after = world_from_lidar.at(time_ns + kHalfNs);
  if (!before || !after) return 0;
  return so3_log(before->R.transpose() * after->R).norm() / (2e-9 * static_cast<double>(kHalfNs));
}

}  // namespace

std::vector<std::string> check_fast_motion(const Drive& drive, const Trajectory& world_from_lidar) {
  if (drive.sensor != Sensor::depth_camera) return {};
  std::vector<int> fast;
  double max_skew_px = 0;
  for (const Frame& frame : drive.frames) {
    const double skew_px = compute_turn_rad_s(world_from_lidar, frame.time_ns) * kFastMotion.readout_s * drive.camera.fx;
    if (skew_px > kFastMotion.max_skew_px) fast.push_back(frame.number);
    max_skew_px = std::max(max_skew_px, skew_px);
  }
  if (fast.empty()) return {};
  return {
      fmt::format("the camera rotates fast: by up to {:.0f} px during the readout of a rolling shutter, in frames {}; these "
                  "images may be blurred and skewed, which is not corrected; move the camera more slowly",
                  max_skew_px, format_ranges(fast))};
}

}  // namespace dvi::diagnostics
