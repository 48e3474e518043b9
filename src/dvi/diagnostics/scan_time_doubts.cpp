#include "dvi/diagnostics/scan_time_doubts.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/odometry/sharpness.h"

namespace dvi::diagnostics {
namespace {

constexpr std::size_t kScans = 12;      // that are compared
constexpr double kLeastSpeed = 3;       // meters a second: below, the motion within a scan is hardly above its noise
constexpr double kLeastGain = 0.001;    // meters of spread; returns and poses are the same, so that their noise is shared
constexpr double kLeastFraction = 0.9;  // of the spread as read, that the other reading may have at most

// Meters that the sensor goes during the scans from `first` on; none where a pose is missing.
double way(const Drive& drive, const Trajectory& world_from_lidar, std::size_t first, std::size_t count) {
  const auto begin = world_from_lidar.at(drive.scan_headers[first].time_ns),
             end = world_from_lidar.at(drive.scan_headers[first + count - 1].time_ns);
  return begin && end ? (end->t - begin->t).norm() : 0;
}

// Those scans with the times of their points multiplied.
Drive with_times(const Drive& drive, std::size_t first, std::size_t count, float factor) {
  Drive out;
  const auto begin = drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(first);
  out.scan_headers.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
  out.scans = Lazy<Scan>(count, 1, [scans = drive.scans, first, factor](std::size_t i) {
    Scan scan = *scans[first + i];
    for (float& time : scan.time) time *= factor;
    return scan;
  });
  return out;
}

bool has_times(const Scan& scan) {
  const auto [low, high] = std::minmax_element(scan.time.begin(), scan.time.end());
  return low != scan.time.end() && *high - *low > 0.01F;
}

}  // namespace

std::vector<std::string> scan_time_doubts(const Drive& drive, const Trajectory& world_from_lidar) {
  const std::size_t count = std::min(kScans, drive.scan_headers.size());
  if (drive.sensor != Sensor::lidar || count < kScans / 2 || world_from_lidar.empty()) return {};
  std::size_t best = 0;  // where it is fastest
  double farthest = 0;
  for (std::size_t first = 0; first + count <= drive.scan_headers.size(); first += count / 2)
    if (const double meters = way(drive, world_from_lidar, first, count); meters > farthest) farthest = meters, best = first;
  const auto span = static_cast<double>(drive.scan_headers[best + count - 1].time_ns - drive.scan_headers[best].time_ns) * 1e-9;
  if (farthest < kLeastSpeed * span || !has_times(*drive.scans[best])) return {};
  const auto spread = [&](float factor) {
    return odometry::measure_sharpness(with_times(drive, best, count, factor), world_from_lidar);
  };
  const odometry::Sharpness as_read = spread(1);
  if (!as_read.known()) return {};
  const auto better = [&](const odometry::Sharpness& other) {
    return other.known() && other.total_m() + kLeastGain < as_read.total_m() &&
           other.total_m() < kLeastFraction * as_read.total_m();
  };
  if (const odometry::Sharpness still = spread(0); better(still)) {
    const odometry::Sharpness back = spread(-1);
    if (better(back) && back.total_m() < still.total_m())
      return {
          fmt::format("the LiDAR looks to turn the other way: scans lie within {:.1f} cm of each other instead of {:.1f}; "
                      "give [lidar] rotation in dvi.toml",
                      100 * back.total_m(), 100 * as_read.total_m())};
    return {
        fmt::format("scans look compensated already, or the LiDAR turns the other way: without the times of their points they "
                    "lie within {:.1f} cm of each other instead of {:.1f}; give [lidar] rotation in dvi.toml, such as \"none\"",
                    100 * still.total_m(), 100 * as_read.total_m())};
  }
  return {};
}

}  // namespace dvi::diagnostics
