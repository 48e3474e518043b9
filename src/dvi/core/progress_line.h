#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace dvi {

/// How far the run is that a stage is part of.
struct RunProgress {
  std::size_t number = 0, count = 0;   ///< of its stages, from 1
  std::optional<double> seconds_left;  ///< of all of it; none: not known yet
};

/// How far a stage is.
struct StageProgress {
  std::string stage;
  std::size_t done = 0, total = 0;  ///< units of work; a total of 0 is unknown
  double seconds = 0;               ///< since the stage began
  std::optional<RunProgress> of_run = std::nullopt;

  /// Seconds until the end at the mean rate so far. None while the rate is unknown: in the first second, before three units or
  /// five seconds, and before 2 % of the units are done.
  std::optional<double> seconds_left() const;
  /// "12.3/s", or "2.5 s each" where that is slower than one a second; empty while nothing is done.
  std::string rate() const;
};

/// "40 s", "2:05 min", "1:07 h".
std::string duration(double seconds);

/// A bar for a terminal of so many columns, which it does not fill: the line would wrap. What does not fit is left out, first
/// the rate, then the bar, then the time. Of a run: "7/15 fill [###...] 34/120  1:20 min left", the time that of the run.
std::string bar_line(const StageProgress& at, bool ended, std::size_t columns);

/// One line of a log: "map: 30 of 100, 12.0/s, 6 s left". `ended`: "map: done, 9 s". Of a run: "7/15 map: ...".
std::string log_line(const StageProgress& at, bool ended);

}  // namespace dvi
