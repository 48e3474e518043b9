#include "dvi/datasets/scan_time.h"

#include <cmath>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::datasets {
namespace {

constexpr double kRevolutionRad = 2 * std::numbers::pi;

double compute_azimuth(const Eigen::Vector3f& p) { return std::atan2(p.y(), p.x()); }

double wrap_angle(double angle) {
  angle = std::fmod(angle, kRevolutionRad);
  return angle < 0 ? angle + kRevolutionRad : angle;
}

// Converts a fraction of the scan to seconds after the stamp.
class Clock {
 public:
  explicit Clock(const ScanHeader& header)
      : start_(1e-9 * static_cast<double>(header.start_ns - header.time_ns)),
        length_(1e-9 * static_cast<double>(header.end_ns - header.start_ns)) {}
  float operator()(double fraction) const { return static_cast<float>(start_ + fraction * length_); }

 private:
  double start_, length_;
};

constexpr double kMaxTimeS = 10;  // after the start of a scan; a larger time is of another unit or clock

}  // namespace

std::vector<float> times_by_azimuth(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header,
                                    const Rotation& rotation) {
  std::vector<float> times(points.size(), 0.0F);
  if (rotation.turn == Turn::none) return times;
  const double sign = rotation.turn == Turn::clockwise ? 1 : -1;
  const Clock at(header);
  for (std::size_t i = 0; i < points.size(); ++i)
    times[i] = at(wrap_angle(sign * (rotation.first_azimuth - compute_azimuth(points[i]))) / kRevolutionRad);
  return times;
}

std::vector<float> times_in_order(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header) {
  constexpr double kMaxDisorderRad = 0.2;  // by which returns may be out of order
  std::vector<float> times(points.size(), 0.0F);
  if (points.empty()) return times;
  const double first = compute_azimuth(points.front());
  double span = wrap_angle(first - compute_azimuth(points.back()));
  if (span < std::numbers::pi) span += kRevolutionRad;  // slightly more than one revolution, or exactly one
  const Clock at(header);
  double furthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double angle = wrap_angle(first - compute_azimuth(points[i]));
    if (furthest < std::numbers::pi && angle > kRevolutionRad - kMaxDisorderRad) angle -= kRevolutionRad;
    if (furthest > std::numbers::pi && angle < kMaxDisorderRad) angle += kRevolutionRad;
    furthest = std::max(furthest, angle);
    times[i] = at(angle / span);
  }
  return times;
}

Scan to_scan(media::PointCloud cloud, const ScanHeader& header, const ScanClock& clock) {
  Scan scan;
  const double start_s = 1e-9 * static_cast<double>(header.start_ns - clock.clock_offset_ns);
  const double length_s = 1e-9 * static_cast<double>(header.end_ns - header.start_ns);
  if (cloud.t.empty() || clock.times.use == media::PointTimes::Use::none) {
    scan.time = times_by_azimuth(cloud.points, header, clock.rotation);
  } else {
    const Clock at(header);
    for (const double after : media::to_seconds_after_start(cloud.t, clock.times, start_s, length_s)) {
      if (!(std::abs(after) <= kMaxTimeS))
        throw InputError(header.file, fmt::format("a time of its points is {:.4g} s after the start of the scan", after),
                         "correct the times, or remove the field");
      scan.time.push_back(at(0) + static_cast<float>(after));
    }
  }
  scan.points = std::move(cloud.points);
  scan.intensity = std::move(cloud.intensity);
  scan.ring = std::move(cloud.ring);
  scan.file_points = cloud.file_points;
  scan.file_index = std::move(cloud.file_index);
  return scan;
}

}  // namespace dvi::datasets
