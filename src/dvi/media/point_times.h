#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace dvi::media {

/// Finds the index of the time field among field names of drivers and tools: t, time, timestamp, offset_time, scalar_GpsTime
/// and so on, in upper or lower case. Returns nothing if there is no such field.
std::optional<std::size_t> find_time_field(const std::vector<std::string>& names);

/// The scan that the values of a time field belong to.
struct TimedScan {
  double period_s = 0.1;  ///< time from one scan to the next
  double start_s = 0;     ///< start of the scan (its stamp in a bag), on the clock of the recording
  double turn_share = 1;  ///< share of a revolution that its points cover; below 1 for scans cropped to a field of view
};

/// The meaning of the values of a scan's time field. It is the same for all scans of a sensor.
struct PointTimes {
  enum class Use {
    times,     ///< the time of each point
    one_time,  ///< the same for all points, within the scan but not its start: the time to which the scan was compensated
    none,      ///< (nearly) equal: the scan was compensated for motion, or the field was never set
    unknown    ///< the unit or the origin cannot be inferred; `text` states the reason
  };
  enum class Zero {
    scan_start,
    scan_middle,
    scan_end,
    recording_clock,  ///< absolute, on the clock of the recording
    first_point       ///< absolute, on another clock: only differences between points are known
  };
  Use use = Use::times;
  Zero zero = Zero::scan_start;
  double unit_s = 1;  ///< seconds per unit of the values
  std::string text;   ///< for messages, after the name of the field: "are nanoseconds after the start of the scan"

  /// Returns whether the times are seconds after the start of the scan, as the documentation requires.
  bool usual() const { return use == Use::times && zero == Zero::scan_start && unit_s == 1; }
};

/// Infers the unit (seconds, milliseconds, microseconds, nanoseconds, or fractions of a scan) and the origin of times from the
/// values alone. The times of a scan span at least half of its period (times the share of a revolution that its points cover),
/// and at most two and a half periods. Values that are not finite are ignored. A late scan of the recording is a better example
/// than the first one, in which a clock that starts with the recording looks like times after the start of the scan.
PointTimes infer_point_times(const std::vector<double>& values, const TimedScan& scan);

/// Computes the share of a revolution about z that points cover, in steps of 5 degrees.
double compute_turn_share(const std::vector<Eigen::Vector3f>& points);

/// Converts values to seconds after the start of a scan, by the meaning of its sensor's times. The scan takes `length_s` and
/// starts at `start_s` on the clock of the recording. Requires Use::times or Use::one_time.
std::vector<double> to_seconds_after_start(const std::vector<double>& values, const PointTimes& times, double start_s,
                                           double length_s);

}  // namespace dvi::media
