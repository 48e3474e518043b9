#include "dvi/sections/section.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::sections {
namespace {

/// Returns the frame where an overlap ends that begins at frame `from` and goes to the first (-1) or last (1) frame.
std::size_t find_overlap_end(const Drive& target, std::size_t from, int direction, std::size_t frames) {
  const std::size_t last = target.frames.size() - 1;
  const std::size_t most = direction < 0 ? from : last - from;
  std::optional<SE3> previous = target.poses.at(target.frames[from].time_ns);
  double length_m = 0;
  std::size_t steps = 0;
  const auto is_long = [&] { return steps >= frames && (target.poses.empty() || length_m >= kSections.overlap_m); };
  while (steps < most && !is_long() && steps < frames * kSections.max_overlap_factor) {
    ++steps;
    const std::size_t frame = direction < 0 ? from - steps : from + steps;
    const std::optional<SE3> pose = target.poses.at(target.frames[frame].time_ns);
    if (pose && previous) length_m += (pose->t - previous->t).norm() * target.world_scale;
    if (pose) previous = pose;
  }
  return direction < 0 ? from - steps : from + steps;
}

/// Returns the times of the first and last frames of a range of numbers.
TimeSpan span_of(const Drive& drive, const FrameRange& range) {
  const auto first = std::partition_point(drive.frames.begin(), drive.frames.end(),
                                          [&](const Frame& frame) { return frame.number < range.first; });
  const auto after =
      std::partition_point(first, drive.frames.end(), [&](const Frame& frame) { return frame.number <= range.last; });
  return {first->time_ns, (after - 1)->time_ns};
}

}  // namespace

std::size_t count_sections(const job::Job& job, std::size_t frames) {
  if (job::is_baseline(job.method)) return 1;
  if (job.sections > 0) return static_cast<std::size_t>(job.sections);
  return std::max<std::size_t>(1, (frames + kSections.automatic_frames - 1) / kSections.automatic_frames);
}

std::vector<Section> cut_into_sections(const Drive& target, std::size_t count, const job::Job& job) {
  const std::size_t frames = target.frames.size();
  if (count == 0 || frames < 2 * count)
    throw UsageError(fmt::format("{} frames cannot be cut into {} sections: at most {}", frames, count,
                                 std::max<std::size_t>(1, frames / 2)));
  const int gap = job.options.sample.max_frame_gap;
  const std::size_t overlap = gap > 0 ? static_cast<std::size_t>(gap) : kSections.overlap_frames;
  std::vector<Section> sections;
  const auto number_of = [&](std::size_t frame) { return target.frames[frame].number; };
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k * frames / count, last = (k + 1) * frames / count - 1;
    sections.push_back(
        {k + 1,
         count,
         {number_of(first), number_of(last)},
         {number_of(find_overlap_end(target, first, -1, overlap)), number_of(find_overlap_end(target, last, 1, overlap))}});
  }
  return sections;
}

std::vector<Border> find_borders(const Drive& target, const std::vector<Section>& sections) {
  std::vector<Border> borders;
  for (std::size_t k = 0; k + 1 < sections.size(); ++k) {
    const TimeSpan before = span_of(target, sections[k].own);
    const TimeSpan after = span_of(target, sections[k + 1].own);
    const std::int64_t border = before.last + (after.first - before.last) / 2;
    const std::int64_t overlap =
        std::min(span_of(target, sections[k].read).last - border, border - span_of(target, sections[k + 1].read).first);
    const std::int64_t half = std::min(border - before.first, after.last - border) / 2;
    borders.push_back({border, std::max<std::int64_t>(0, std::min(overlap, half))});
  }
  return borders;
}

std::size_t section_at(const std::vector<Border>& borders, std::int64_t time_ns) {
  return static_cast<std::size_t>(
      std::partition_point(borders.begin(), borders.end(), [&](const Border& border) { return border.time_ns < time_ns; }) -
      borders.begin());
}

job::Job section_job(const job::Job& whole, const Section& section, const fs::path& folder) {
  job::Job job = whole;
  job.out = folder.string();
  job.read.frames = fmt::format("{}:{}", section.read.first, section.read.last);
  job.sections = 1;
  return job;
}

}  // namespace dvi::sections
