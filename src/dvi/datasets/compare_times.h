#pragma once

#include <optional>
#include <string>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// Estimates by how many seconds the clock of `a` is ahead of that of `b`. The spans indicate a difference if they do not
/// overlap, if they have the same length but different starts, or if they differ by a common clock error (leap seconds, time
/// zones). Returns nothing otherwise. `step_s` is the difference between the spans of agreeing clocks.
std::optional<double> clock_difference_s(const TimeSpan& a, const TimeSpan& b, double step_s);

/// Describes two spans: "the images are from 1037.05 s to 1038.95 s, the scans from 1000.05 s to 1001.95 s".
std::string describe_spans(const std::string& a_name, const TimeSpan& a, const std::string& b_name, const TimeSpan& b);

/// Compares the times of the images with those of the scans and given poses, for a whole drive. Adds a warning if they seem to
/// be of different clocks. Throws InputError if no image lies near any scan. Both state the difference and the remedy.
void compare_times(Drive& drive);

/// Describes the frames without a given pose: "no given pose near frames 3-7". Returns nothing if all frames have one or if no
/// poses are given.
std::optional<std::string> describe_unposed(const Drive& drive);

/// Describes the spans of given poses and images and the difference of their clocks, if frames have no pose and the spans
/// indicate why.
std::optional<std::string> describe_pose_clock(const Drive& drive);

}  // namespace dvi::datasets
