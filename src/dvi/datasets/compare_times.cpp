#include "dvi/datasets/compare_times.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/median.h"
#include "dvi/core/text.h"

namespace dvi::datasets {
namespace {

// The smallest differences that indicate different clocks.
struct ClockParams {
  double min_difference_s = 0.5;  // smaller offsets are found better by alignment and optical flow
  double min_steps = 3;
  double startup_s = 2;  // sensors start and stop at times that differ by up to this
};
constexpr ClockParams kClockParams;

/// A difference between clocks that has a common cause, in seconds.
struct KnownDifference {
  double seconds;
  const char* name;
};
constexpr KnownDifference kKnownDifferences[] = {
    {37, "TAI against UTC"}, {18, "GPS time against UTC"}, {19, "TAI against GPS time"}};
constexpr double kHourS = 3600, kMaxTimeZones = 14;

const char* find_cause(double seconds) {
  const double size = std::abs(seconds);
  for (const KnownDifference& known : kKnownDifferences)
    if (std::abs(size - known.seconds) < kClockParams.min_difference_s) return known.name;
  const double hours = std::round(size / kHourS);
  return hours >= 1 && hours <= kMaxTimeZones && std::abs(size - hours * kHourS) < kClockParams.startup_s ? "a time zone"
                                                                                                          : nullptr;
}

template <class Stamped>
TimeSpan find_span(const std::vector<Stamped>& items) {
  return {items.front().time_ns, items.back().time_ns};
}

template <class Stamped>
double find_median_step_s(const std::vector<Stamped>& items) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < items.size(); ++i) steps.push_back(ns_to_s(items[i].time_ns - items[i - 1].time_ns));
  return steps.empty() ? 0 : median(std::move(steps));
}

std::string describe_difference(double seconds) {
  const char* cause = find_cause(seconds);
  return fmt::format("{:.2f} s {}{}", std::abs(seconds), seconds > 0 ? "ahead" : "behind",
                     cause != nullptr ? fmt::format(" ({})", cause) : "");
}

/// Describes the spans of images and scans and the difference of their clocks, if the spans indicate one. Throws InputError if
/// no scan belongs to any image.
std::optional<std::string> describe_scan_clock(const Drive& drive) {
  if (drive.scan_headers.empty()) return std::nullopt;
  const auto names_offset = [](const std::string& warning) { return warning.find("offset_s") != std::string::npos; };
  if (std::any_of(drive.warnings.begin(), drive.warnings.end(), names_offset))
    return std::nullopt;  // found already by the recorder's clock
  const TimeSpan images = find_span(drive.frames), scans = find_span(drive.scan_headers);
  const double step = std::max(find_median_step_s(drive.frames), find_median_step_s(drive.scan_headers));
  const std::optional<double> ahead = clock_difference_s(images, scans, 1.5 * step);
  if (!ahead) return std::nullopt;
  const std::string spans = describe_spans("images", images, "scans", scans);
  const std::string remedy =
      fmt::format("the clock of the images seems to be {}: add {:.2f} to offset_s of [camera.{}] in dvi.toml",
                  describe_difference(*ahead), -*ahead, drive.camera_name);
  if (images.first > drive.scan_headers.back().end_ns || images.last < drive.scan_headers.front().start_ns)
    throw InputError(drive.path, spans + ": no scan belongs to any image", remedy);
  return spans + ", " + remedy;
}

}  // namespace

std::optional<double> clock_difference_s(const TimeSpan& a, const TimeSpan& b, double step_s) {
  const double starts = ns_to_s(a.first - b.first), ends = ns_to_s(a.last - b.last), mean = 0.5 * (starts + ends);
  if (ns_to_s(a.first - b.last) > step_s || ns_to_s(b.first - a.last) > step_s) return mean;
  if (std::abs(mean) < std::max(kClockParams.min_difference_s, kClockParams.min_steps * step_s)) return std::nullopt;
  const double lengths = std::abs(starts - ends);
  if (lengths <= step_s || (lengths <= kClockParams.startup_s && find_cause(mean) != nullptr)) return mean;
  return std::nullopt;
}

std::string describe_spans(const std::string& a_name, const TimeSpan& a, const std::string& b_name, const TimeSpan& b) {
  return fmt::format("the {} are from {:.2f} s to {:.2f} s, the {} from {:.2f} s to {:.2f} s", a_name, ns_to_s(a.first),
                     ns_to_s(a.last), b_name, ns_to_s(b.first), ns_to_s(b.last));
}

std::optional<std::string> describe_unposed(const Drive& drive) {
  if (drive.poses.empty()) return std::nullopt;
  std::vector<int> unposed;
  for (const Frame& frame : drive.frames)
    if (!drive.poses.at(frame.time_ns)) unposed.push_back(frame.number);
  return unposed.empty() ? std::nullopt : std::optional("no given pose near frames " + format_ranges(unposed));
}

std::optional<std::string> describe_pose_clock(const Drive& drive) {
  if (!describe_unposed(drive)) return std::nullopt;
  const TimeSpan poses = find_span(drive.poses.poses()), images = find_span(drive.frames);
  const double step = std::max(find_median_step_s(drive.poses.poses()), find_median_step_s(drive.frames));
  const std::optional<double> ahead = clock_difference_s(poses, images, 1.5 * step);
  if (!ahead) return std::nullopt;
  return fmt::format("{}: the clock of the poses seems to be {}; add {:.2f} s to the times of the poses",
                     describe_spans("poses", poses, "images", images), describe_difference(*ahead), -*ahead);
}

void compare_times(Drive& drive) {
  if (const auto words = describe_scan_clock(drive))
    drive.warnings.push_back(*words);
  else if (const auto of_poses = describe_pose_clock(drive))
    drive.warnings.push_back(*of_poses);
}

}  // namespace dvi::datasets
