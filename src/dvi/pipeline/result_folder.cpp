#include "dvi/pipeline/result_folder.h"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/version.h"
#include "dvi/pipeline/frame_files.h"
#include "dvi/pipeline/map_files.h"
#include "dvi/pipeline/report_json.h"  // IWYU pragma: keep
#include "dvi/pipeline/result_media.h"

namespace dvi::pipeline {
namespace {

constexpr const char* kResultSchema = "dvi-result/1";

fs::path job_file(const fs::path& out) { return out / ".dvi/job.json"; }

// Which drives a result is of; a folder made from others is refused.
std::string identity_of(const Recordings& drives) {
  std::string identity;
  for (const Recording& open : drives)
    identity += fs::absolute(open.drive.path).lexically_normal().string() + " " + open.drive.camera_name + "\n";
  return identity;
}

// All that the frames depend on: options, and every file that is read.
std::string fingerprint_of(Job job, const Recordings& drives) {
  job.out.clear();
  job.memory_mb = 0;  // changes no pixel
  Fingerprint print;
  print.add(read_file("/proc/self/exe"));  // another build may make other pixels
  print.add(job.table().dump_toml());
  for (const Recording& open : drives) add_files(print, open.drive);
  return print.hex();
}

// What sources.json says: the image behind each number in a frame's receipts.
nlohmann::json sources_json(const Views& views, const Recordings& drives) {
  nlohmann::json sources = nlohmann::json::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Drive& drive = drives[static_cast<std::size_t>(views[i].drive)].drive;
    const Frame& frame = drive.frames[views[i].frame];
    const cv::Vec3f& gain = views[i].gain;
    sources.push_back({{"number", i},
                       {"drive", fs::absolute(drive.path).lexically_normal().string()},
                       {"camera", drive.camera_name},
                       {"frame", frame.name},
                       {"file", fs::absolute(frame.file).lexically_normal().string()},
                       {"exposure_gain", std::array<float, 3>{gain[2], gain[1], gain[0]}}});
  }
  return {{"schema", "dvi-sources/1"}, {"sources", sources}};
}

}  // namespace

const std::vector<std::string>& picture_folders() {
  static const std::vector<std::string> folders{"frames",       "masks",         "kind",       "provenance",
                                                "sources_used", "harmonisation", "confidence", "depth"};
  return folders;
}

void require_usable_folder(const fs::path& out, bool force) {
  if (force || fs::exists(job_file(out)) || !fs::exists(out)) return;
  if (!fs::is_directory(out) || !fs::is_empty(out))
    throw InputError(out, "exists and is no result of dvi", "choose another folder, or --force to write into it");
}

ResultFolder::ResultFolder(const Job& job, const Recordings& drives)
    : job_(job), drives_(drives), out_(job.out), identity_(identity_of(drives)), fingerprint_(fingerprint_of(job, drives)) {
  if (!fs::exists(job_file(out_))) return;
  const nlohmann::json old = nlohmann::json::parse(read_file(job_file(out_)), nullptr, false);
  const bool ours = old.is_object() && old.value("schema", "") == kResultSchema && old.value("identity", "") == identity_;
  if (!ours && !job.force)
    throw InputError(out_, "is the result of another drive", "choose another folder, or --force to replace it");
  same_ = ours && old.value("fingerprint", "") == fingerprint_;
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;  // a destructor cannot do more than try
  const fs::path frames = out_ / ".dvi/frames";
  if (created_ && (!fs::exists(frames, ignored) || fs::is_empty(frames, ignored))) fs::remove_all(out_, ignored);
}

std::optional<RunReport> ResultFolder::finished_report(Progress& progress) const {
  if (!same_ || !fs::exists(out_ / "report.json")) return std::nullopt;
  const RunReport report = read_run_report(out_ / "report.json");
  for (const FrameReport& frame : report.frames)
    if (!fs::exists(record(frame.name))) return std::nullopt;
  progress.note("every frame is finished already: nothing to do");
  return report;
}

void ResultFolder::claim() {
  created_ = !fs::exists(out_);
  for (const std::string& folder : picture_folders()) make_folder(out_ / folder);
  remove_temporaries(out_);
  if (!same_) {
    fs::remove_all(out_ / ".dvi/frames");
    fs::remove(out_ / "report.json");  // it tells of other frames, and marks a result as whole
  }
  make_folder(out_ / ".dvi/frames");
  const nlohmann::json job{{"schema", kResultSchema}, {"identity", identity_}, {"fingerprint", fingerprint_}};
  write_file(job_file(out_), json_text(job) + "\n");
}

std::string ResultFolder::frame_name(const Views& views, std::size_t view) const {
  return drives_.front().drive.frames[views[view].frame].name;
}

std::vector<std::size_t> ResultFolder::missing_frames(const Views& views) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < views.of_drive(0).second; ++i) {
    names_.push_back(frame_name(views, i));
    if (!fs::exists(record(names_.back()))) missing.push_back(i);
  }
  made_ = missing.size();
  return missing;
}

std::function<void(std::size_t, const FilledView&)> ResultFolder::writer(const Views& views, const align::Cameras& cameras,
                                                                         CpuClock& cpu, Progress& progress) const {
  return [&, this](std::size_t view, const FilledView& finished) {
    const Frame& frame = drives_.front().drive.frames[views[view].frame];
    const std::string report = to_json(frame_report(frame, finished, cameras.views[view]));
    cpu.time("write", [&] {
      write_pictures(out_, frame.name, finished.frame, views, view);
      write_file(record(frame.name), report);
    });
    progress.advance();
  };
}

void ResultFolder::remove_other_frames() const {
  const auto is_ours = [&](const fs::path& file) {
    return std::find(names_.begin(), names_.end(), file.stem().string()) != names_.end();
  };
  for (const std::string& folder : picture_folders())
    for (const fs::path& file : list_files(out_ / folder, {".png"}))
      if (!is_ours(file)) fs::remove(file);
  for (const fs::path& file : list_files(out_ / ".dvi/frames", {".json"}))
    if (!is_ours(file)) fs::remove(file);
}

RunReport ResultFolder::report(const RunResults& results, const Progress& progress) const {
  RunReport report;
  report.version = kVersion;
  report.method = to_string(job_.method);
  report.baseline = is_baseline(job_.method);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const bool aligned = i < results.cameras.drives.size();
    report.drives.push_back(
        drive_report(drives_[i].drive, results.poses[i].choice, aligned ? &results.cameras.drives[i] : nullptr));
  }
  for (const std::string& name : names_) {
    report.frames.push_back(read_frame_report(record(name)));
    report.hole += report.frames.back().hole;
  }
  if (results.map != nullptr) report.map = map_report(*results.map);
  report.cost = cost_report(progress, results.cpu, made_);
  report.warnings = progress.warnings();
  return report;
}

RunReport ResultFolder::complete(const RunResults& results, Progress& progress) {
  const Drive& target = drives_.front().drive;
  remove_other_frames();
  write_file(out_ / "sources.json", json_text(sources_json(results.views, drives_)) + "\n");
  if (results.map != nullptr) {
    write_map_files(out_ / "map", *results.map, results.views, target);
    write_file(out_ / "map/map.json", json_text(map_report(*results.map)) + "\n");
  } else {
    fs::remove_all(out_ / "map");  // left by another method
  }
  write_media(out_, target, names_, job_.options.video, progress);
  progress.end();
  Job resolved = job_;
  resolved.out = fs::absolute(job_.out).lexically_normal().string();
  write_file(out_ / "dvi.toml", effective_toml(resolved));
  RunReport finished = report(results, progress);
  write_file(out_ / "report.json", to_json(finished) + "\n");
  return finished;
}

}  // namespace dvi::pipeline
