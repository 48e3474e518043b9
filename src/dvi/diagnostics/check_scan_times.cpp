#include "dvi/diagnostics/check_scan_times.h"

#include <algorithm>

#include <fmt/format.h>

#include "dvi/odometry/sharpness.h"

namespace dvi::diagnostics {
namespace {

/// The displacement of the sensor during the scans from `first` on; 0 if a pose is missing.
double measure_displacement_m(const Drive& drive, const Trajectory& world_from_lidar, std::size_t first, std::size_t count) {
  const auto begin = world_from_lidar.at(drive.scan_headers[first].time_ns),
             end = world_from_lidar.at(drive.scan_headers[first + count - 1].time_ns);
  return begin && end ? (end->t - begin->t).norm() : 0;
}

/// Returns these scans with the times of their points multiplied by a factor.
Drive scale_times(const Drive& drive, std::size_t first, std::size_t count, float factor) {
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

std::vector<std::string> check_scan_times(const Drive& drive, const Trajectory& world_from_lidar) {
  const std::size_t count = std::min(kScanTime.scans, drive.scan_headers.size());
  if (drive.sensor != Sensor::lidar || count < kScanTime.scans / 2 || world_from_lidar.empty()) return {};
  std::size_t best = 0;  // the fastest part of the drive
  double farthest = 0;
  for (std::size_t first = 0; first + count <= drive.scan_headers.size(); first += count / 2)
    if (const double meters = measure_displacement_m(drive, world_from_lidar, first, count); meters > farthest)
      farthest = meters, best = first;
  const auto span = static_cast<double>(drive.scan_headers[best + count - 1].time_ns - drive.scan_headers[best].time_ns) * 1e-9;
  if (farthest < kScanTime.min_speed_m_s * span || !has_times(*drive.scans[best])) return {};
  const auto measure = [&](float factor) {
    return odometry::measure_sharpness(scale_times(drive, best, count, factor), world_from_lidar);
  };
  const odometry::Sharpness as_read = measure(1);
  if (!as_read.known()) return {};
  const auto is_better = [&](const odometry::Sharpness& other) {
    return other.known() && other.total_m() + kScanTime.min_gain_m < as_read.total_m() &&
           other.total_m() < kScanTime.max_relative * as_read.total_m();
  };
  if (const odometry::Sharpness without = measure(0); is_better(without)) {
    const odometry::Sharpness negated = measure(-1);
    if (is_better(negated) && negated.total_m() < without.total_m())
      return {
          fmt::format("the LiDAR seems to rotate in the other direction: scans differ by {:.1f} cm instead of {:.1f} cm; "
                      "give [lidar] rotation in dvi.toml",
                      100 * negated.total_m(), 100 * as_read.total_m())};
    return {
        fmt::format("scans seem to be compensated already, or the LiDAR rotates in the other direction: without the times of "
                    "their points they differ by {:.1f} cm instead of {:.1f} cm; give [lidar] rotation in dvi.toml, such as "
                    "\"none\"",
                    100 * without.total_m(), 100 * as_read.total_m())};
  }
  return {};
}

}  // namespace dvi::diagnostics
