#include "dvi/diagnostics/fast_motion.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/core/text.h"

namespace dvi::diagnostics {
namespace {

constexpr double kReadout = 0.03;  // seconds from the first row of an image to the last; cameras at 30 Hz hardly read faster
constexpr double kBentPx = 15;     // by half of it the first and last rows are off

// Radians a second, of the camera about a time; 0 where the poses do not say.
double turning(const Trajectory& world_from_lidar, std::int64_t time_ns) {
  constexpr std::int64_t kHalf = 15'000'000;
  const auto before = world_from_lidar.at(time_ns - kHalf), after = world_from_lidar.at(time_ns + kHalf);
  if (!before || !after) return 0;
  return so3_log(before->R.transpose() * after->R).norm() / (2e-9 * static_cast<double>(kHalf));
}

}  // namespace

std::vector<std::string> fast_motion(const Drive& drive, const Trajectory& world_from_lidar) {
  if (drive.sensor != Sensor::depth_camera) return {};
  std::vector<int> fast;
  double most_px = 0;
  for (const Frame& frame : drive.frames) {
    const double px = turning(world_from_lidar, frame.time_ns) * kReadout * drive.camera.fx;
    if (px > kBentPx) fast.push_back(frame.number);
    most_px = std::max(most_px, px);
  }
  if (fast.empty()) return {};
  return {
      fmt::format("the camera turns fast: by up to {:.0f} px while an image of a rolling shutter is read, in frames {}; they "
                  "may be blurred and bent, which is not corrected",
                  most_px, format_ranges(fast))};
}

}  // namespace dvi::diagnostics
