#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace dvi::media {

/// The place among the names of fields of one that holds times of points, as drivers and tools call it: t, time, timestamp,
/// offset_time, scalar_GpsTime and so on, in upper or lower case. None where there is no such field.
std::optional<std::size_t> find_time_field(const std::vector<std::string>& names);

/// The scan that values of a time field belong to.
struct TimedScan {
  double period_s = 0.1;  ///< from one scan to the next
  double start_s = 0;     ///< when the scan starts (of a bag: its stamp), on the clock of the recording
  double turn_share = 1;  ///< share of a full turn that its points cover; less than 1 for scans cropped to a field of view
};

/// What the values of the time field of a scan mean. All scans of a sensor share one meaning.
struct PointTimes {
  enum class Use {
    times,     ///< the time of each point
    one_time,  ///< the same for all points, within the scan and not its start: what the scan was compensated to
    none,      ///< all (nearly) the same: the scan was compensated for motion, or the field was never set
    unknown    ///< a unit or an origin that cannot be inferred; `text` says why
  };
  enum class Zero {
    scan_start,
    scan_middle,
    scan_end,
    recording_clock,  ///< absolute, on the clock of the recording
    first_point       ///< absolute, on another clock: only differences between the points are known
  };
  Use use = Use::times;
  Zero zero = Zero::scan_start;
  double unit_s = 1;  ///< seconds per unit of the values
  std::string text;   ///< for messages, after the name of the field: "are nanoseconds after the start of the scan"

  /// Whether they are seconds after the start of the scan, as the documentation asks for.
  bool usual() const { return use == Use::times && zero == Zero::scan_start && unit_s == 1; }
};

/// Infers the unit (seconds, milliseconds, microseconds, nanoseconds, or fractions of a scan) and the origin of times from the
/// values alone: the times of a scan span at least half of its period (of the share of a turn that its points cover), and not
/// more than two and a half periods. Values that are not finite are ignored. A late scan of the recording is a better example
/// than its first, where a clock that starts with the recording looks like times after the start of the scan.
PointTimes infer_point_times(const std::vector<double>& values, const TimedScan& scan);

/// The share of a full turn about z that points cover, in steps of 5 degrees.
double turn_share(const std::vector<Eigen::Vector3f>& points);

/// Seconds after the start of a scan for each value, by the meaning that its sensor's times have. The scan takes `length_s`
/// and starts at `start_s` on the clock of the recording. Requires Use::times or
/// Use::one_time.
std::vector<double> seconds_after_start(const std::vector<double>& values, const PointTimes& times, double start_s,
                                        double length_s);

}  // namespace dvi::media
