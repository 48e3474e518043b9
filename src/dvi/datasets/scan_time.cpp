#include "dvi/datasets/scan_time.h"

#include <cmath>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::datasets {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double azimuth(const Eigen::Vector3f& p) { return std::atan2(p.y(), p.x()); }

double wrapped(double angle) {
  angle = std::fmod(angle, kTurn);
  return angle < 0 ? angle + kTurn : angle;
}

// Seconds after the stamp of a fraction of the scan.
class Clock {
 public:
  explicit Clock(const ScanHeader& header)
      : start_(1e-9 * static_cast<double>(header.start_ns - header.time_ns)),
        length_(1e-9 * static_cast<double>(header.end_ns - header.start_ns)) {}
  float operator()(double fraction) const { return static_cast<float>(start_ + fraction * length_); }

 private:
  double start_, length_;
};

constexpr double kMaxTimeS = 10;  // after the start of a scan; more is of another unit or clock

}  // namespace

std::vector<float> times_by_azimuth(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header,
                                    const Rotation& rotation) {
  std::vector<float> times(points.size(), 0.0F);
  if (rotation.turn == Turn::none) return times;
  const double sign = rotation.turn == Turn::clockwise ? 1 : -1;
  const Clock at(header);
  for (std::size_t i = 0; i < points.size(); ++i)
    times[i] = at(wrapped(sign * (rotation.first_azimuth - azimuth(points[i]))) / kTurn);
  return times;
}

std::vector<float> times_in_order(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header) {
  constexpr double kSeam = 0.2;  // radians that returns may be out of order
  std::vector<float> times(points.size(), 0.0F);
  if (points.empty()) return times;
  const double first = azimuth(points.front());
  double span = wrapped(first - azimuth(points.back()));
  if (span < std::numbers::pi) span += kTurn;  // a little more than one turn, or exactly one
  const Clock at(header);
  double furthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double angle = wrapped(first - azimuth(points[i]));
    if (furthest < std::numbers::pi && angle > kTurn - kSeam) angle -= kTurn;
    if (furthest > std::numbers::pi && angle < kSeam) angle += kTurn;
    furthest = std::max(furthest, angle);
    times[i] = at(angle / span);
  }
  return times;
}

Scan to_scan(media::PointCloud cloud, const ScanHeader& header, const Rotation& rotation, const media::PointTimes& times,
             std::int64_t clock_offset_ns) {
  Scan scan;
  const double start_s = 1e-9 * static_cast<double>(header.start_ns - clock_offset_ns);
  const double length_s = 1e-9 * static_cast<double>(header.end_ns - header.start_ns);
  if (cloud.t.empty() || times.use == media::PointTimes::Use::none) {
    scan.time = times_by_azimuth(cloud.points, header, rotation);
  } else {
    const Clock at(header);
    for (const double after : media::seconds_after_start(cloud.t, times, start_s, length_s)) {
      if (!(std::abs(after) <= kMaxTimeS))
        throw InputError(header.file, fmt::format("a time of its points is {:.4g} s after the start of the scan", after),
                         "correct the times, or leave the field out");
      scan.time.push_back(at(0) + static_cast<float>(after));
    }
  }
  scan.points = std::move(cloud.points);
  scan.intensity = std::move(cloud.intensity);
  scan.ring = std::move(cloud.ring);
  return scan;
}

}  // namespace dvi::datasets
