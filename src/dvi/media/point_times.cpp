#include "dvi/media/point_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "dvi/core/text.h"

namespace dvi::media {
namespace {

// The relation between the times of a scan and its period.
struct PointTimeParams {
  double min_periods = 0.5, max_periods = 2.5;  // spanned by the times of a scan
  double origin_tolerance = 0.25;               // fraction of that span; the first and the last point may be missing
};
constexpr PointTimeParams kTimeParams;

struct TimeRange {
  double first = 0, last = 0;
  double span() const { return last - first; }
  TimeRange in_seconds(double unit_s) const { return {first * unit_s, last * unit_s}; }
};

// Returns a sample of several thousand finite values in ascending order.
std::vector<double> sort_sample(const std::vector<double>& values) {
  constexpr std::size_t kMaxSamples = 8192;
  std::vector<double> sample;
  const std::size_t step = values.size() / kMaxSamples + 1;
  for (std::size_t i = 0; i < values.size(); i += step)
    if (std::isfinite(values[i])) sample.push_back(values[i]);
  std::sort(sample.begin(), sample.end());
  return sample;
}

// Returns the range without the outermost 0.1 %, which may be values of points that were not measured.
TimeRange find_robust_range(const std::vector<double>& sorted) {
  const std::size_t skipped = sorted.size() / 1000;
  return {sorted[skipped], sorted[sorted.size() - 1 - skipped]};
}

std::optional<double> infer_unit(const TimeRange& values, const TimedScan& scan) {
  const double least = kTimeParams.min_periods * std::min(scan.turn_share, 1.0);
  std::optional<double> unit;
  for (const double candidate : {1.0, 1e-3, 1e-6, 1e-9}) {
    const double periods = values.span() * candidate / scan.period_s;
    if (periods >= least && periods <= kTimeParams.max_periods) unit = candidate;
  }
  constexpr double kRounding = 1e-3, kMaxPeriodsOfSeconds = 1.5;
  const bool fractions = values.first >= -kRounding && values.last <= 1 + kRounding && values.span() >= least;
  if (fractions && (!unit || (*unit == 1 && values.span() > kMaxPeriodsOfSeconds * scan.period_s))) return scan.period_s;
  return unit;
}

std::optional<PointTimes::Zero> infer_zero(const TimeRange& seconds, const TimedScan& scan) {
  constexpr double kMaxOffset = 1.25;  // periods
  const double tolerance = kTimeParams.origin_tolerance * seconds.span(), farthest = kMaxOffset * scan.period_s;
  if (std::abs(seconds.first) <= tolerance) return PointTimes::Zero::scan_start;
  if (std::abs(seconds.last) <= tolerance) return PointTimes::Zero::scan_end;
  if (std::abs(seconds.first + seconds.last) <= tolerance) return PointTimes::Zero::scan_middle;
  // A scan that is cropped to a field of view begins later or ends earlier.
  if (seconds.first > 0 && seconds.last <= farthest) return PointTimes::Zero::scan_start;
  if (seconds.last < 0 && seconds.first >= -farthest) return PointTimes::Zero::scan_end;
  if (std::abs(seconds.first - scan.start_s) <= farthest) return PointTimes::Zero::recording_clock;
  if (seconds.first > 0 || seconds.last < 0) return PointTimes::Zero::first_point;
  return std::nullopt;
}

std::string describe_unit(double unit_s) {
  if (unit_s == 1) return "seconds";
  if (unit_s == 1e-3) return "milliseconds";
  if (unit_s == 1e-6) return "microseconds";
  return unit_s == 1e-9 ? "nanoseconds" : "fractions of a scan";
}

std::string describe_zero(PointTimes::Zero zero) {
  switch (zero) {
    case PointTimes::Zero::scan_start:
      return "after the start of the scan";
    case PointTimes::Zero::scan_middle:
      return "before and after the middle of the scan";
    case PointTimes::Zero::scan_end:
      return "before the end of the scan";
    case PointTimes::Zero::recording_clock:
      return "on the clock of the recording";
    default:
      return "on a clock of their own: a scan starts with its first point";
  }
}

PointTimes make_unused(PointTimes::Use use, std::string text) {
  return {.use = use, .zero = PointTimes::Zero::scan_start, .unit_s = 1, .text = std::move(text)};
}

// CloudCompare writes "scalar_GpsTime", Livox "offset_time", Hesai "timestamp", RoboSense "timeOffset".
std::string normalize_field_name(const std::string& name) {
  std::string plain = to_lower_case(name);
  if (plain.starts_with("scalar_")) plain.erase(0, std::string("scalar_").size());
  std::erase(plain, '_');
  return plain;
}

}  // namespace

std::optional<std::size_t> find_time_field(const std::vector<std::string>& names) {
  for (const char* known :
       {"t", "time", "timestamp", "offsettime", "timeoffset", "gpstime", "reltime", "relativetime", "deltatime", "pointtime"})
    for (std::size_t i = 0; i < names.size(); ++i)
      if (normalize_field_name(names[i]) == known) return i;
  return std::nullopt;
}

PointTimes infer_point_times(const std::vector<double>& values, const TimedScan& scan) {
  using Use = PointTimes::Use;
  const std::vector<double> sorted = sort_sample(values);
  if (sorted.empty()) return make_unused(Use::none, "are not finite (NaN)");
  const TimeRange range = find_robust_range(sorted);
  if (range.span() == 0) {
    const bool within = range.first > 0 && range.first <= scan.period_s;
    return make_unused(within ? Use::one_time : Use::none, fmt::format("are all {:.10g}", range.first));
  }
  const std::optional<double> unit = infer_unit(range, scan);
  if (!unit) {
    const std::string span = fmt::format("go from {:.10g} to {:.10g}", range.first, range.last);
    if (range.span() < scan.period_s)
      return make_unused(Use::none, fmt::format("{}, less than half of a scan of {:.4g} s", span, scan.period_s));
    return make_unused(Use::unknown, fmt::format("{}, which matches a scan of {:.4g} s in no unit", span, scan.period_s));
  }
  // An example is seconds since 1970 in 32 bits.
  constexpr std::size_t kMinSamples = 64, kMinDistinct = 8;
  std::vector<double> distinct = sorted;
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  if (sorted.size() >= kMinSamples && distinct.size() < kMinDistinct)
    return make_unused(Use::none, fmt::format("have only {} different values", distinct.size()));
  const TimeRange seconds = range.in_seconds(*unit);
  const std::optional<PointTimes::Zero> zero = infer_zero(seconds, scan);
  if (!zero)
    return make_unused(Use::unknown,
                       fmt::format("go from {:.4g} to {:.4g} s around neither the start, the middle nor the end of the scan",
                                   seconds.first, seconds.last));
  return {Use::times, *zero, *unit, fmt::format("are {} {}", describe_unit(*unit), describe_zero(*zero))};
}

double compute_turn_share(const std::vector<Eigen::Vector3f>& points) {
  constexpr std::size_t kSectors = 72;
  std::array<bool, kSectors> covered{};
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite() || (point.x() == 0 && point.y() == 0)) continue;
    const float turn = (std::atan2(point.y(), point.x()) + std::numbers::pi_v<float>) / (2 * std::numbers::pi_v<float>);
    covered[std::min(static_cast<std::size_t>(turn * static_cast<float>(kSectors)), kSectors - 1)] = true;
  }
  return static_cast<double>(std::count(covered.begin(), covered.end(), true)) / kSectors;
}

std::vector<double> to_seconds_after_start(const std::vector<double>& values, const PointTimes& times, double start_s,
                                           double length_s) {
  using Zero = PointTimes::Zero;
  double first = 0;
  if (times.zero == Zero::first_point && !values.empty())
    first = times.unit_s * *std::min_element(values.begin(), values.end());
  const double zero_s = times.zero == Zero::scan_start    ? 0
                        : times.zero == Zero::scan_middle ? 0.5 * length_s
                        : times.zero == Zero::scan_end    ? length_s
                        : times.zero == Zero::first_point ? -first
                                                          : -start_s;
  std::vector<double> seconds;
  seconds.reserve(values.size());
  for (const double value : values) seconds.push_back(value * times.unit_s + zero_s);
  return seconds;
}

}  // namespace dvi::media
