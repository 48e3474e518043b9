#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace dvi {

/// The progress of the run that a stage belongs to.
struct RunProgress {
  std::size_t number = 0, count = 0;   ///< the stage's number, from 1, and the number of stages
  std::optional<double> seconds_left;  ///< of the whole run; none: not known yet
};

/// The progress of a stage.
struct StageProgress {
  std::string stage;
  std::size_t done = 0, total = 0;  ///< units of work; a total of 0 is unknown
  double seconds = 0;               ///< since the stage began
  std::optional<RunProgress> of_run = std::nullopt;

  /// Estimates the seconds until the end at the mean rate. Returns nothing while the rate is unknown: in the first second,
  /// before three units or five seconds, and before 2 % of the units are done.
  std::optional<double> seconds_left() const;
  /// Formats the rate: "12.3/s", or "2.5 s each" below one per second; empty if nothing is done yet.
  std::string rate() const;
};

/// Formats a duration: "40 s", "2:05 min", "1:07 h".
std::string format_duration(double seconds);

/// Formats a bar that is narrower than a terminal of `columns`, since the line would wrap otherwise. If the width is too small,
/// omits the rate, then the bar, then the time. For a run: "7/15 fill [###...] 34/120  1:20 min left" with the time of the run.
std::string format_bar_line(const StageProgress& at, bool ended, std::size_t columns);

/// Formats a line of a log: "map: 30 of 100, 12.0/s, 6 s left", or "map: done, 9 s" if `ended`. For a run: "7/15 map: ...".
std::string format_log_line(const StageProgress& at, bool ended);

}  // namespace dvi
