#include "dvi/result/result_folder.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"
#include "dvi/core/json_optional.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/core/version.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/objects/stationary_objects.h"
#include "dvi/report/report.h"
#include "dvi/result/fill_import.h"
#include "dvi/result/fingerprints.h"
#include "dvi/result/frame_files.h"
#include "dvi/result/manifest.h"
#include "dvi/result/map_files.h"
#include "dvi/result/plan_manifest.h"
#include "dvi/result/read_result.h"
#include "dvi/result/section_folder.h"
#include "dvi/result/segment_store.h"
#include "dvi/result/source_masks.h"
#include "dvi/result/sources_json.h"
#include "dvi/result/stage_json.h"
#include "dvi/result/usable_folder.h"
#include "dvi/result/write_report.h"

namespace dvi::result {
namespace {

fs::path job_file(const fs::path& out) { return out / ".dvi/job.json"; }

/// Returns the counts of the removed objects, and sentences about those that remain visible.
nlohmann::json objects_summary(const std::vector<objects::RemovedObject>& removed) {
  nlohmann::json out = objects::count_objects(removed);
  out["residue"] = objects::describe_visible(removed);
  return out;
}

}  // namespace

std::string describe_progress(const fs::path& out) {
  const std::vector<std::string> begun = list_begun_frames(out);
  const auto finished = std::count_if(begun.begin(), begun.end(), [&](const std::string& name) {
    const std::optional<Manifest> manifest = read_manifest(frame_manifest(out, name));
    return manifest && manifest->content;
  });
  std::vector<std::string> kept = list_cached_stages(out);
  if (finished > 0) kept.push_back(fmt::format("{} finished frames", finished));
  if (has_sections(out)) kept.emplace_back("plans of sections");
  if (kept.empty()) return "no part is finished; the same command starts again";
  return fmt::format("{} are kept; the same command continues the run", fmt::join(kept, ", "));
}

ResultFolder::ResultFolder(const job::Job& job, const inputs::Recordings& drives, std::string content)
    : job_(job),
      drives_(drives),
      out_(job.out),
      identity_(identity_of(drives)),
      content_(content.empty() ? content_of(drives) : std::move(content)),
      fingerprint_(fingerprint_of(job, content_)) {
  require_apart(job);
  if (cameras().size() > 1) require_camera_names(out_, cameras());
  refuse_other_drives();
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;  // a destructor must not throw
  const auto unused = [&](const fs::path& folder) { return !fs::exists(folder, ignored) || fs::is_empty(folder, ignored); };
  if (created_ && unused(out_ / ".dvi/frames") && unused(out_ / ".dvi/stages") && !has_sections(out_))
    fs::remove_all(out_, ignored);
}

void ResultFolder::refuse_other_drives() const {
  if (job_.force || !fs::exists(job_file(out_))) return;
  const std::optional<Manifest> old = read_manifest(job_file(out_));
  if (old ? old->fingerprint != compute_hash(identity_) : nlohmann::json::accept(read_file(job_file(out_))))
    throw InputError(out_, "is the result of another drive", "choose another folder, or --force to replace it");
}

bool ResultFolder::is_finished(const std::string& name) const { return is_confirmed(frame_manifest(name), fingerprint_, out_); }

std::string ResultFolder::format_options() const {
  job::Job resolved = job_;
  resolved.out = fs::absolute(job_.out).lexically_normal().string();
  return job::effective_toml(resolved);
}

std::optional<RunReport> ResultFolder::read_finished_report(Progress& progress) const {
  if (!is_confirmed(result_manifest(), fingerprint_, out_)) return std::nullopt;
  const std::optional<RunReport> read = read_run_report(out_ / "report.json");
  if (!read || !fs::exists(out_ / "dvi.toml") || read_file(out_ / "dvi.toml") != format_options() ||
      !read_manifest(job_file(out_)))
    return std::nullopt;
  const std::vector<std::string> names = read->frame_names();
  std::vector<char> finished(names.size());
  parallel_for(finished.size(), [&](std::size_t i) { finished[i] = is_finished(names[i]) ? 1 : 0; });
  if (std::count(finished.begin(), finished.end(), 0) > 0) return std::nullopt;
  progress.note("every frame is finished already: nothing to do");
  if (const auto hole = read->document().at("hole").get<HoleReport>(); hole.imported > 0)
    progress.note(fmt::format("{} pixels hold the fill of another program; dvi import-fill {} --undo restores those of the run",
                              hole.imported, out_.string()));
  if (!is_report_complete(out_)) write_report(out_, {}, progress);
  return read;
}

void ResultFolder::claim() {
  const bool created = !fs::exists(out_);
  make_folder(out_ / ".dvi/frames");
  lock_.emplace(out_, out_ / ".dvi/lock");
  created_ = created;     // only the process that locked the folder may remove it
  refuse_other_drives();  // another run may have begun and ended since the constructor
  for (const fs::path& folder : list_own_folders(out_, cameras())) {
    make_folder(folder);
    remove_temporaries(folder);
  }
  write_manifest(job_file(out_), compute_hash(identity_), {{"drives", identity_}});
}

void ResultFolder::claim_section() {
  const bool created = !fs::exists(out_);
  make_folder(out_ / ".dvi/frames");
  lock_.emplace(out_, out_ / ".dvi/lock", FolderLock::Hold::shared);
  created_ = created;
  refuse_other_drives();
  write_manifest(job_file(out_), compute_hash(identity_), {{"drives", identity_}});
}

void ResultFolder::join() {
  lock_.emplace(out_, out_ / ".dvi/lock", FolderLock::Hold::shared);
  require_plan_of(out_, job_, drives_);  // another process may have made a new plan since the constructor
  for (const fs::path& folder : list_own_folders(out_, cameras())) make_folder(folder);
}

void ResultFolder::claim_plan() {
  claim();
  require_plan_of(out_, job_, drives_, content_);
  planned_ = true;
}

StageCache ResultFolder::make_stage_cache(Progress& progress, StageCache::Missing missing) const {
  return {out_, stages_fingerprint_of(job_, content_), progress, missing};
}

void ResultFolder::write_plan(const Progress& progress, std::size_t sections) const {
  write_file(out_ / "dvi.toml", format_options());
  write_cost(out_, "plan", fingerprint_, make_cost_report(progress, CpuClock(), 0));
  result::write_plan(out_, {kVersion, program_fingerprint(), listing_of(drives_), content_, fingerprint_, sections});
}

void ResultFolder::write_section_options(const fs::path& section) const {
  write_file(options_of_whole(section), format_options());
}

void ResultFolder::write_fill_cost(const std::vector<std::size_t>& frames, const CpuClock& cpu,
                                   const Progress& progress) const {
  if (!frames.empty())
    write_cost(out_, fmt::format("fill-{}-{}", frames.front(), frames.back()), fingerprint_,
               make_cost_report(progress, cpu, frames.size()));
}

void ResultFolder::write_section_cost(std::size_t section, const CostReport& cost) {
  write_cost(out_, fmt::format("section-{}", section), fingerprint_, cost);
  planned_ = true;
}

std::vector<std::string> ResultFolder::cameras() const {
  std::vector<std::string> names;
  for (const inputs::Recording& open : drives_)
    if (open.is_cleaned) names.push_back(open.drive.camera_name);
  return names.size() > 1 ? names : std::vector<std::string>{""};
}

std::string ResultFolder::frame_name(const View& view) const {
  const auto sequence = static_cast<std::size_t>(view.sequence);
  return join_frame_name(cameras()[sequence], drives_[sequence].drive.frames[view.frame].name);
}

std::vector<std::size_t> ResultFolder::begin_fill(const Views& views, const std::vector<std::size_t>& frames,
                                                  Progress& progress) {
  names_.clear();
  for (std::size_t i = 0; i < views.targets(); ++i) names_.push_back(frame_name(views[i]));
  std::vector<char> finished(frames.size()), stale(frames.size()), imported(frames.size());
  parallel_for(frames.size(), [&](std::size_t i) {
    const std::string& name = names_[frames[i]];
    finished[i] = is_finished(name) ? 1 : 0;
    stale[i] = finished[i] == 0 && fs::exists(frame_manifest(name)) ? 1 : 0;
    imported[i] = stale[i] != 0 && read_external_file(out_, name) ? 1 : 0;
  });
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (finished[i] == 0) missing.push_back(frames[i]);
  if (const auto again = std::count(stale.begin(), stale.end(), 1); again > 0)
    progress.note(fmt::format("{} of {} frames in {} have other options or inputs, or are damaged: they are made again", again,
                              frames.size(), out_.string()));
  if (const auto lost = std::count(imported.begin(), imported.end(), 1); lost > 0)
    progress.note(fmt::format("the fill of another program in {} of them is replaced; dvi import-fill imports it again", lost));
  if (!missing.empty())
    for (const fs::path& mark : {result_manifest(), out_ / "report.json", out_ / "report.html"}) fs::remove(mark);
  made_ = missing.size();
  return missing;
}

std::function<void(std::size_t, const FilledView&)> ResultFolder::make_writer(const Views& views, const align::Cameras& cameras,
                                                                              CpuClock& cpu,
                                                                              const FinishedFrame& hand_on) const {
  const auto source_masks = std::make_shared<SourceMasks>(out_, views);
  return [&, this, source_masks, hand_on](std::size_t view, const FilledView& finished) {
    const Frame& frame = drives_[static_cast<std::size_t>(views[view].sequence)].drive.frames[views[view].frame];
    const std::string name = frame_name(views[view]);
    cpu.time("write", [&] {
      write_stream(frame_manifest(name), [](std::ostream&) {});  // marks the pictures as dvi's, but unfinished
      write_pictures({out_, name, view}, finished.frame, views);
      std::vector<std::string> files = list_pictures(name);
      const std::vector<std::string> masks = source_masks->write(finished.frame.provenance);
      files.insert(files.end(), masks.begin(), masks.end());
      write_manifest(
          frame_manifest(name),
          {fingerprint_, list_contents(out_, files),
           std::make_shared<const nlohmann::json>(frame_json(camera_of_frame(name), frame, finished, cameras.views[view]))});
      write_report_frame_manifest(out_, name, view, fingerprint_);
    });
    hand_on(view, finished.frame);
  };
}

void ResultFolder::remove_other_frames() const {
  const std::set<std::string> own(names_.begin(), names_.end());
  for (const std::string& name : list_begun_frames(out_)) {
    if (own.contains(name)) continue;
    for (const std::string& picture : list_pictures(name))
      if (const fs::path file = out_ / picture; !fs::is_symlink(file.parent_path())) fs::remove(file);
    fs::remove(frame_manifest(name));
  }
}

void ResultFolder::remove_unlisted_files() const {
  std::set<std::string> own;
  for (const std::string& name : names_)
    if (const std::optional<Manifest> manifest = read_manifest(frame_manifest(name)))
      for (const ListedFile& file : manifest->files) own.insert(file.file);
  std::vector<std::string> folders{".dvi/masks/"};
  for (const std::string& camera : cameras())
    for (const char* folder : {"frames/", "kind/"}) folders.push_back(file_before_import(join_frame_name(camera, folder)));
  for (const std::string& folder : folders)
    for (const fs::path& file : list_files(out_ / folder, {".png"}))
      if (!own.contains(folder + file.filename().string())) fs::remove(file);
}

void ResultFolder::remove_map() const {
  if (!fs::is_directory(fs::symlink_status(out_ / "map"))) return;
  for (const std::string& file : list_other_files(out_, cameras()))
    if (file.starts_with("map/")) fs::remove(out_ / file);
  if (fs::is_empty(out_ / "map")) fs::remove(out_ / "map");
}

RunReport ResultFolder::make_report(const RunResults& results, const std::vector<objects::RemovedObject>& removed,
                                    const metrics::FiguresWithoutTruth& figures, const Progress& progress) const {
  nlohmann::json frames = nlohmann::json::array(), camera_names = nlohmann::json::array();
  for (std::size_t k = 0; k < cameras().size(); ++k) camera_names.push_back(drives_[k].drive.camera_name);
  HoleReport hole;
  for (const std::string& name : names_) {
    const std::optional<Manifest> manifest = read_manifest(frame_manifest(name));
    if (!manifest || !manifest->content)
      throw InputError(frame_manifest(name), "was changed by another program during the run", "run again");
    frames.push_back(*manifest->content);
    hole += manifest->content->at("hole").get<HoleReport>();
  }
  const objects::CameraEvidence evidence = inputs::evidence_of(drives_.front(), results.poses.front().world_from_lidar);
  const std::optional<objects::StationaryObjects> stationary = objects::count_stationary(evidence, job_.removal());
  CostReport cost = make_cost_report(progress, results.cpu, made_);
  if (planned_) cost += sum_costs(out_, fingerprint_);
  return RunReport({{"schema", RunReport::kSchema},
                    {"version", kVersion},
                    {"method", to_string(job_.method)},
                    {"baseline", job::is_baseline(job_.method)},
                    {"cameras", camera_names},
                    {"drives", drives_json(drives_, results.poses, results.cameras)},
                    {"hole", hole},
                    {"artifacts", figures.artifacts},
                    {"look", figures.look},
                    {"stationary", stationary},
                    {"objects", objects_summary(removed)},
                    {"map", results.map != nullptr ? map_json(*results.map) : nlohmann::json()},
                    {"cost", cost},
                    {"warnings", progress.warnings()},
                    {"frames", frames}});
}

std::vector<objects::RemovedObject> ResultFolder::list_removed(const RunResults& results) const {
  std::vector<objects::RemovedObject> all;
  const std::vector<std::string> names = cameras();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const objects::CameraEvidence evidence = inputs::evidence_of(drives_[k], results.poses[k].world_from_lidar);
    const ResultOfCamera result{out_, names[k], static_cast<int>(k)};
    for (objects::RemovedObject& object : objects::list_removed_objects(
             evidence, results.objects[k], job_.options.masks, make_result_reader(result, drives_[k].drive, results.views))) {
      object.camera = names[k];
      all.push_back(std::move(object));
    }
  }
  return all;
}

std::vector<FinishedFrames> ResultFolder::list_finished(const Views& views) const {
  std::vector<FinishedFrames> cameras_frames;
  for (std::size_t k = 0; k < cameras().size(); ++k) {
    const auto [first, last] = views.of_sequence(static_cast<int>(k));
    const Drive& drive = drives_[k].drive;
    cameras_frames.push_back(
        {.out = out_,
         .names = {names_.begin() + static_cast<std::ptrdiff_t>(first), names_.begin() + static_cast<std::ptrdiff_t>(last)},
         .size = {drive.camera.width, drive.camera.height},
         .read_input = [&drive, &views, first](std::size_t i) { return *drive.images[views[first + i].frame]; },
         .options = job_.options.video});
  }
  return cameras_frames;
}

void ResultFolder::store_segments(const Views& views, const std::vector<std::size_t>& filled, Progress& progress) const {
  std::set<std::string> names;
  for (const std::size_t view : filled) names.insert(names_[view]);
  progress.begin("video", 0);
  for (const FinishedFrames& frames : list_finished(views)) result::store_segments(frames, names, progress.tick());
  progress.end();
}

RunReport ResultFolder::complete(const RunResults& results, Progress& progress) {
  const Drive& target = drives_.front().drive;
  remove_other_frames();
  remove_unlisted_files();
  write_file(out_ / "sources.json", json_text(sources_json(results.views, drives_)) + "\n");
  const std::vector<objects::RemovedObject> removed = list_removed(results);
  write_file(out_ / "objects.json", json_text(objects::objects_json(removed)) + "\n");
  write_file(out_ / "objects.csv", objects::objects_csv(removed));
  if (results.map != nullptr) {
    write_map_files(out_ / "map", {*results.map, results.views, target,
                                   collect_object_paths(*results.objects.front().labels, results.views,
                                                        results.poses.front().world_from_lidar),
                                   cameras()});
    write_file(out_ / "map/map.json", json_text(map_json(*results.map)) + "\n");
  } else {
    remove_map();  // left by an earlier run with another method
    remove_stages(out_);
  }
  progress.begin("video", names_.size());
  for (const FinishedFrames& frames : list_finished(results.views)) write_media(frames, progress.tick());
  SegmentStore(out_).remove_all();
  const metrics::FiguresWithoutTruth figures = metrics::measure_without_truth(out_, names_, progress.parts());
  progress.end();
  write_file(out_ / "dvi.toml", format_options());
  std::optional<RunReport> finished;
  progress.begin("report", names_.size());
  write_report(
      job_, {names_, fingerprint_},
      [&] {
        progress.end();
        finished = make_report(results, removed, figures, progress);
        const std::string text = to_json(*finished);
        write_file(out_ / "report.json", text + "\n");
        return text;
      },
      progress.tick());
  write_manifest(result_manifest(), {fingerprint_, list_contents(out_, list_other_files(out_, cameras()))});
  return *finished;
}

}  // namespace dvi::result
