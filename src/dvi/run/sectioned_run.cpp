#include "dvi/run/sectioned_run.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/datasets/reader.h"
#include "dvi/inputs/make_views.h"
#include "dvi/inputs/rig.h"
#include "dvi/media/write_image.h"
#include "dvi/result/plan_manifest.h"
#include "dvi/result/section_folder.h"
#include "dvi/result/stage_fields.h"  // IWYU pragma: keep
#include "dvi/run/run_stages.h"
#include "dvi/sections/join_map.h"
#include "dvi/sections/join_objects.h"
#include "dvi/sections/join_poses.h"
#include "dvi/sections/join_views.h"

namespace dvi::run {
namespace {

using result::FilledView, result::ResultFolder, result::StageCache;
using sections::PlannedSection, sections::Section;

inputs::Recordings open_whole(const job::Job& job) {
  Progress silent(ProgressStyle::quiet);  // each section reports the warnings of the drive
  inputs::Recordings drives =
      inputs::add_other_cameras(inputs::open_recordings(job, inputs::MaskNeed::required, silent), job, silent);
  inputs::require_provenance_range(drives);
  return drives;
}

/// Repeats the warnings of sections, each once, with the sections that it is about unless it is about all.
void merge_warnings(const std::vector<std::vector<std::string>>& of_sections, Progress& progress) {
  std::vector<std::string> order;
  std::map<std::string, std::set<std::size_t>> sections;
  for (std::size_t k = 0; k < of_sections.size(); ++k)
    for (const std::string& warning : of_sections[k]) {
      if (!sections.contains(warning)) order.push_back(warning);
      sections[warning].insert(k + 1);
    }
  for (const std::string& warning : order) {
    const std::set<std::size_t>& where = sections[warning];
    progress.warn(where.size() == of_sections.size()
                      ? warning
                      : fmt::format("section{} {}: {}", where.size() == 1 ? "" : "s", fmt::join(where, ", "), warning));
  }
}

/// Refers to sources by their numbers in the whole drive.
FilledView renumber(FilledView filled, const std::vector<std::size_t>& numbers, const cv::Vec3f& gain) {
  cv::Mat_<cv::Vec3w> provenance = filled.frame.provenance.clone();
  for (cv::Vec3w& from : provenance)
    if (from[0] > 0) from[0] = static_cast<ushort>(numbers[from[0] - std::size_t{1}] + 1);
  filled.frame.provenance = provenance;
  filled.frame.gain = gain;
  return filled;
}

/// Returns the file of the mask of a view of the target's drive, in the folder of the section that fills the frames of its
/// time.
fs::path mask_file(const fs::path& section, const Drive& drive, const View& view) {
  return section / "masks" / drive.camera_name / (drive.frames[view.frame].name + ".png");
}

}  // namespace

std::size_t count_sections(const job::Job& job) {
  if (job.sections > 1) job::require_one_camera(job.read.camera, "a plan in sections");
  if (job::has_other_cameras(job.read.camera)) return 1;
  if (job.sections > 0 || job::is_baseline(job.method)) return sections::count_sections(job, 0);
  datasets::ReadOptions read;
  read.camera = job::first_camera(job.read.camera);
  read.topics = job.read.topics;
  if (!job.read.frames.empty()) read.frames = job::parse_frames(job.read.frames);
  return sections::count_sections(job, datasets::read_drive(job.target, read).frames.size());
}

SectionedRun::SectionedRun(const job::Job& job, std::size_t sections, Progress& progress)
    : job_(job),
      progress_(progress),
      drives_(open_whole(job)),
      sections_(sections::cut_into_sections(drives_.front().drive, sections, job)),
      borders_(sections::find_borders(drives_.front().drive, sections_)) {}

fs::path SectionedRun::folder_of(const Section& section) const {
  return result::section_folder(job_.out, section.number, section.count);
}

std::vector<int> SectionedRun::plan(std::size_t section) {
  const Section& planned = sections_[section - 1];
  ResultFolder whole(job_, drives_, "planned in sections");  // the content of the drive is known when all are planned
  whole.claim_section();
  {
    SectionRun own(sections::section_job(job_, planned, folder_of(planned)), progress_.style());
    own.run.folder().claim();
    own.run.plan();
    write_masks(planned, own.run);
    own.run.folder().write_plan(own.progress);
  }
  whole.write_section_options(folder_of(planned));
  std::vector<int> numbers;
  for (const Frame& frame : drives_.front().drive.frames)
    if (planned.own.contains(frame.number)) numbers.push_back(frame.number);
  return numbers;
}

void SectionedRun::write_masks(const Section& section, const DriveRun& planned) const {
  const Views& views = planned.views();
  const fs::path folder = folder_of(section);
  for (const inputs::Recording& open : planned.drives())
    if (open.rig_of.value_or(0) == 0) make_folder(folder / "masks" / open.drive.camera_name);
  parallel_in_order(views.size(), [&](std::size_t i) {
    if (views[i].drive != 0 || section_of(views[i]) + 1 != section.number) return;
    const Drive& drive = planned.drives()[static_cast<std::size_t>(views[i].sequence)].drive;
    media::write_png(mask_file(folder, drive, views[i]), *views.masks[i]);
  });
}

/// Reads the masks of the views of the target's drive. Those of source drives are known to each section only.
Lazy<cv::Mat1b> SectionedRun::read_masks() const {
  return Lazy<cv::Mat1b>(views_.size(), [this](std::size_t i) {
    const View& view = views_[i];
    const Drive& drive = drives_[static_cast<std::size_t>(view.sequence)].drive;
    return media::read_png_gray(mask_file(folder_of(sections_[section_of(view)]), drive, view),
                                {view.camera.width, view.camera.height});
  });
}

SectionedRun::SectionRun SectionedRun::open_planned(const Section& section) const {
  const fs::path folder = folder_of(section);
  return {sections::section_job(job_, section, folder), ProgressStyle::quiet, result::read_plan(folder).content};
}

std::vector<PlannedSection> SectionedRun::load_sections(Progress& progress) const {
  progress.begin("sections", sections_.size());
  std::vector<PlannedSection> loaded;
  std::vector<std::vector<std::string>> warnings;
  for (const Section& section : sections_) {
    SectionRun own = open_planned(section);
    own.run.folder().join();
    loaded.push_back(own.run.load_section(section));
    warnings.push_back(own.progress.warnings());
    progress.advance();
  }
  progress.end();
  merge_warnings(warnings, progress);
  return loaded;
}

void SectionedRun::open_folder() {
  result::require_planned_sections(job_.out, sections_.size());
  folder_.emplace(job_, drives_, result::content_of_sections(job_.out, sections_.size()));
}

void SectionedRun::load_joint(StageCache::Missing missing) {
  const StageCache stages = folder_->make_stage_cache(progress_, missing);
  std::vector<PlannedSection> sections;
  poses_ = stages.load_or_compute("poses", [&] {
    sections = load_sections(progress_);
    return sections::join_poses(sections, drives_, borders_, progress_);
  });
  const auto loaded = [&]() -> const std::vector<PlannedSection>& {
    if (sections.empty()) sections = load_sections(progress_);
    return sections;
  };
  objects_ = stages.load_or_compute("objects",
                                    [&] { return objects::Objects{sections::join_objects(loaded(), drives_.front().drive)}; });
  const Views posed = inputs::make_views({drives_, poses_, objects::Masks{}}, progress_);
  const auto joint = [&] { return sections::JointViews{loaded(), posed, drives_, borders_}; };
  const auto gains = stages.load_or_compute("exposure", [&] { return sections::join_gains(joint()); });
  cameras_ = stages.load_or_compute("alignment", [&] { return sections::join_cameras(joint(), poses_); });
  views_ = inputs::refine_views(posed, gains, cameras_);
  views_.masks = read_masks();
}

void SectionedRun::join() {
  folder_->claim();
  load_joint(StageCache::Missing::compute);
  for (const Section& section : sections_) {
    const fs::path folder = folder_of(section);
    folder_->write_section_cost(section.number, result::sum_costs(folder, result::read_plan(folder).fingerprint));
  }
}

void SectionedRun::use_plan_to_fill() {
  folder_->join();
  load_joint(StageCache::Missing::refuse);
}

void SectionedRun::use_plan_to_finish() {
  folder_->claim_plan();
  load_joint(StageCache::Missing::refuse);
}

void SectionedRun::fill_section(const Section& section, const std::vector<std::size_t>& frames,
                                const result::FinishedFrame& done) {
  SectionRun own = open_planned(section);
  own.run.folder().join();
  std::vector<std::size_t> numbers;
  own.run.load_plan([&](const Views& planned) {
    numbers = sections::number_views({planned, own.run.drives()}, {views_, drives_});
    // Near the ends of a section, its masks are less complete than those of the neighbor that fills these frames.
    return Lazy<cv::Mat1b>::through(planned.size(), [&, drawn = planned.masks](std::size_t view) {
      const View& of_drive = views_[numbers[view]];
      const bool is_own = of_drive.drive != 0 || section_of(of_drive) + 1 == section.number;
      return is_own ? drawn[view] : views_.masks[numbers[view]];
    });
  });
  std::map<std::size_t, std::size_t> local_of;
  for (std::size_t i = 0; i < numbers.size(); ++i) local_of[numbers[i]] = i;
  std::vector<std::size_t> local;
  for (const std::size_t frame : frames) local.push_back(local_of.at(frame));
  Views written = views_;
  written.masks = Lazy<cv::Mat1b>::through(
      views_.size(), [&, masks = own.run.views().masks](std::size_t view) { return masks[local_of.at(view)]; });
  const auto write = folder_->make_writer(written, cameras_, own.run.cpu(), done);
  own.run.write_frames(local, [&](std::size_t view, const FilledView& filled) {
    write(numbers[view], renumber(filled, numbers, views_[numbers[view]].gain));
  });
  cpu_.add(own.run.cpu().seconds());
}

void SectionedRun::fill_frames(const std::vector<std::size_t>& frames, const result::FinishedFrame& hand_on) {
  const auto done = [&](std::size_t number, const harmonize::FilledFrame& frame) {
    if (hand_on) hand_on(number, frame);
    progress_.advance();
  };
  progress_.begin("fill", frames.size());
  for (const Section& section : sections_) {
    std::vector<std::size_t> own;
    for (const std::size_t frame : frames)
      if (section.own.contains(number_of(frame))) own.push_back(frame);
    if (!own.empty()) fill_section(section, own, done);
  }
  progress_.end();
}

result::RunReport SectionedRun::finish() {
  Progress silent(ProgressStyle::quiet);  // the joint plan repeats the other warnings
  const std::vector<PlannedSection> planned = load_sections(silent);
  std::vector<std::vector<std::string>> warnings;
  progress_.begin("map", sections_.size());
  const map::StaticMap map = sections::join_maps(planned, poses_, borders_, [&](std::size_t k) {
    SectionRun own = open_planned(sections_[k]);
    map::StaticMap loaded = own.run.load_map();
    warnings.push_back(own.progress.warnings());
    progress_.advance();
    return loaded;
  });
  progress_.end();
  merge_warnings(warnings, progress_);
  return folder_->complete(
      {.views = views_, .map = &map, .poses = poses_, .cameras = cameras_, .cpu = cpu_, .objects = objects_}, progress_);
}

}  // namespace dvi::run
