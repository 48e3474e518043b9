#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/job/job.h"

namespace dvi::sections {

/// A part of the target drive that is planned alone, possibly on another machine. It reads more frames than it fills, so that
/// its frames have their sources on both sides.
struct Section {
  std::size_t number = 1;  ///< from 1
  std::size_t count = 1;   ///< sections of the drive
  FrameRange own;          ///< numbers of the frames that it fills
  FrameRange read;         ///< numbers of the frames that it reads: `own` and the overlaps with its neighbors
};

/// Parameters of the cut.
struct SectionParams {
  std::size_t automatic_frames = 10'000;  ///< most frames of a section if the number of sections is not given
  std::size_t overlap_frames = 120;       ///< at least on each side, if sample.max_frame_gap is 0 (all)
  double overlap_m = 100;                 ///< at least on each side, if poses are given: the range of the map around a frame
  std::size_t max_overlap_factor = 4;     ///< limits `overlap_m` where the vehicle hardly moves, relative to the frames
};
inline constexpr SectionParams kSections;

/// Returns the number of sections of a job whose target has `frames` frames; 1 for methods without a plan.
std::size_t count_sections(const job::Job& job, std::size_t frames);

/// Cuts the target into sections with equal numbers of frames. On each side, a section overlaps with its neighbors by
/// sample.max_frame_gap frames, the farthest sources of a frame, and by SectionParams::overlap_m. Throws UsageError if there
/// are fewer than two frames for each section.
std::vector<Section> cut_into_sections(const Drive& target, std::size_t count, const job::Job& job);

/// The border between a section and the next one, in time: halfway between the last frame of the one and the first frame of the
/// other. `reach_ns` is the time on both sides that the overlap covers; it is at most half of each section, so that no time is
/// near two borders.
struct Border {
  std::int64_t time_ns = 0, reach_ns = 0;
};

/// Returns the borders of the sections of a drive in their order, one fewer than sections.
std::vector<Border> find_borders(const Drive& target, const std::vector<Section>& sections);

/// Returns the index of the section that fills the frames at a time of the target.
std::size_t section_at(const std::vector<Border>& borders, std::int64_t time_ns);

/// Returns the job that plans a section: that of the whole drive, limited to the frames of the section, with another folder.
job::Job section_job(const job::Job& whole, const Section& section, const fs::path& folder);

}  // namespace dvi::sections
