#pragma once

#include <optional>
#include <string>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// By how many seconds the clock of `a` is ahead of that of `b`, if their spans tell: they do not overlap, or they have one
/// length and lie apart, or they lie apart by what clocks are set wrong by (leap seconds, time zones). None where nothing
/// speaks for a difference. `step_s`: what the spans may differ by although the clocks agree.
std::optional<double> clock_difference_s(const TimeSpan& a, const TimeSpan& b, double step_s);

/// "the images are from 1037.05 s to 1038.95 s, the scans from 1000.05 s to 1001.95 s"
std::string describe_spans(const std::string& a_name, const TimeSpan& a, const std::string& b_name, const TimeSpan& b);

/// Compares the times of images with those of scans and given poses, of a whole drive. Warns where they look like those of two
/// clocks; InputError where no image lies near any scan. Both name the difference and how to make up for it.
void compare_times(Drive& drive);

/// "no given pose near frames 3-7"; none where all have one or no poses are given.
std::optional<std::string> describe_unposed(const Drive& drive);

/// The spans of given poses and images, and the difference of their clocks, where frames have no pose and the spans tell why.
std::optional<std::string> describe_pose_clock(const Drive& drive);

}  // namespace dvi::datasets
