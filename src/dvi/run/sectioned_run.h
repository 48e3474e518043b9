#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dvi/result/result_folder.h"
#include "dvi/run/drive_run.h"
#include "dvi/sections/section.h"

namespace dvi::run {

/// Returns the number of sections in which a job is planned. Looks at the target's files if their number determines it.
std::size_t count_sections(const job::Job& job);

/// A run of a long drive in sections. Each section is planned alone in its folder (result/section_folder.h), and fills its own
/// frames from its own plan, in its own world. join() gives all views one numbering, and their poses, gains, and objects one
/// world, in which the frames' provenance and all other files are written.
class SectionedRun {
 public:
  SectionedRun(const job::Job& job, std::size_t sections, Progress& progress);

  std::size_t sections() const { return sections_.size(); }

  /// Plans one section, from 1, or loads its stages. Returns the numbers of the frames that it fills.
  std::vector<int> plan(std::size_t section);

  /// Opens the folder of the whole drive. Throws InputError if a section is not planned, or if sections do not belong together.
  void open_folder();
  // The following need open_folder().

  /// Joins the plans of the sections, or loads the joint plan.
  void join();
  /// Uses the joint plan to fill frames together with other processes, or to finish the result alone.
  void use_plan_to_fill();
  void use_plan_to_finish();

  /// As those of DriveRun. They need the joint plan.
  result::ResultFolder& folder() { return *folder_; }
  const Views& views() const { return views_; }
  std::size_t frames() const { return views_.targets(); }
  int number_of(std::size_t frame) const { return drives_.front().drive.frames[views_[frame].frame].number; }
  std::vector<std::size_t> begin_fill(const std::vector<std::size_t>& frames) {
    return folder_->begin_fill(views_, frames, progress_);
  }
  void store_segments(const std::vector<std::size_t>& filled) const { folder_->store_segments(views_, filled, progress_); }
  void fill_frames(const std::vector<std::size_t>& frames, const result::FinishedFrame& hand_on = {});
  result::RunReport finish();
  result::CpuClock& cpu() { return cpu_; }

 private:
  /// A section's run, with a progress of its own, because each section repeats the warnings of the drive.
  struct SectionRun {
    SectionRun(job::Job of_section, ProgressStyle style, std::string content = "")
        : job(std::move(of_section)), progress(style), run(job, progress, std::move(content)) {}
    job::Job job;
    Progress progress;
    DriveRun run;
  };

  fs::path folder_of(const sections::Section& section) const;
  std::size_t section_of(const View& view) const { return sections::section_at(borders_, view.time_ns); }
  void write_masks(const sections::Section& section, const DriveRun& planned) const;
  Lazy<cv::Mat1b> read_masks() const;
  SectionRun open_planned(const sections::Section& section) const;
  std::vector<sections::PlannedSection> load_sections(Progress& progress) const;
  void load_joint(result::StageCache::Missing missing);
  void fill_section(const sections::Section& section, const std::vector<std::size_t>& frames,
                    const result::FinishedFrame& done);

  const job::Job& job_;
  Progress& progress_;
  const inputs::Recordings drives_;
  const std::vector<sections::Section> sections_;
  const std::vector<sections::Border> borders_;
  std::optional<result::ResultFolder> folder_;
  result::CpuClock cpu_;

  inputs::Poses poses_;
  objects::Objects objects_;
  align::Cameras cameras_;
  Views views_;
};

}  // namespace dvi::run
