#include "dvi/pipeline/run_result.h"

#include <nlohmann/json.hpp>

#include "dvi/core/hash.h"
#include "dvi/core/threads.h"
#include "dvi/core/version.h"
#include "dvi/harmonize/receipt.h"
#include "dvi/pipeline/map_files.h"
#include "dvi/pipeline/report.h"
#include "dvi/pipeline/result_media.h"

namespace dvi::pipeline {
namespace {

// Which drives a result is of; a folder made from others is refused.
std::string identity_of(const std::vector<OpenDrive>& drives) {
  std::string identity;
  for (const OpenDrive& open : drives)
    identity += fs::absolute(open.drive.path).lexically_normal().string() + " " + open.drive.camera_name + "\n";
  return identity;
}

// All that the frames depend on: options, and every file that is read.
std::string fingerprint_of(Job job, const std::vector<OpenDrive>& drives) {
  job.out.clear();
  Fingerprint print;
  print.add(read_file("/proc/self/exe"));  // another build may make other pixels
  print.add(job.table().dump_toml());
  for (const OpenDrive& open : drives) add_files(print, open.drive);
  return print.hex();
}

std::vector<std::string> frame_names(const Views& views, const Drive& target) {
  std::vector<std::string> names;
  for (const View& view : views.views)
    if (view.drive == 0) names.push_back(target.frames[view.frame].name);
  return names;
}

}  // namespace

std::optional<std::string> finished_report(const Job& job, const std::vector<OpenDrive>& drives, Progress& progress) {
  const fs::path file = fs::path(job.out) / "report.json";
  if (!fs::exists(file)) return std::nullopt;
  const ResultFolder folder(job.out, identity_of(drives), fingerprint_of(job, drives), job.force);
  if (!fs::exists(file)) return std::nullopt;  // it was of other options or files
  const std::string report = read_file(file);
  const nlohmann::json told = nlohmann::json::parse(report);
  for (const nlohmann::json& frame : told["frames"])
    if (!folder.is_finished(frame["name"])) return std::nullopt;
  progress.note("every frame is finished already: nothing to do");
  return report;
}

RunResult::RunResult(const Job& job, const std::vector<OpenDrive>& drives, const Views& views, Progress& progress)
    : job_(job),
      drives_(drives),
      views_(views),
      progress_(progress),
      names_(frame_names(views, drives.front().drive)),
      folder_(job.out, identity_of(drives), fingerprint_of(job, drives), job.force) {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (!folder_.is_finished(names_[i])) open_.push_back(i);
}

void RunResult::make_frames(const FillFrame& fill_frame, const align::Alignment& alignment, CpuClock& clock) {
  Smoother smoother(fill_frame, 0, names_.size(), job_.options.smooth, clock);
  progress_.begin("fill", open_.size());
  for_blocks(open_.size(), [&](std::size_t first, std::size_t last) {
    const std::vector<std::size_t> block(open_.begin() + static_cast<std::ptrdiff_t>(first),
                                         open_.begin() + static_cast<std::ptrdiff_t>(last));
    const std::vector<FilledView> finished = smoother.finish(block);
    parallel_for(block.size(), [&](std::size_t i) {
      const Frame& frame = drives_.front().drive.frames[views_[block[i]].frame];
      const nlohmann::json record = frame_report(frame, finished[i], alignment.views[block[i]]);
      clock.time("write", [&] {
        const harmonize::FilledFrame& filled = finished[i].frame;
        const cv::Mat_<cv::Vec3w> change =
            harmonize::harmonisation(views_, block[i], to_8bit(filled), filled.provenance, filled.used);
        folder_.write_frame(frame.name, filled, change, record.dump(1));
      });
      progress_.advance();
    });
  });
}

std::string RunResult::complete(const map::StaticMap* map, const align::Alignment& alignment, const CpuClock& clock) {
  const Drive& target = drives_.front().drive;
  const fs::path& out = folder_.path();
  folder_.remove_others(names_);
  write_file(out / "sources.json", sources_report(views_, drives_).dump(1) + "\n");
  if (map) {
    write_map_files(out / "map", *map, views_, target);
    write_file(out / "map/map.json", map_report(*map).dump(1) + "\n");
  } else {
    fs::remove_all(out / "map");  // left by another method
  }
  write_media(out, target, names_, job_.options.video, progress_);
  progress_.end();
  Job resolved = job_;
  resolved.out = fs::absolute(job_.out).lexically_normal().string();
  write_file(out / "dvi.toml", resolved.table().dump_toml());

  std::vector<nlohmann::json> frames;
  for (const std::string& name : names_) frames.push_back(nlohmann::json::parse(folder_.frame_record(name)));
  const nlohmann::json report = {{"schema", "dvi-report/1"},
                                 {"version", kVersion},
                                 {"method", job_.method},
                                 {"baseline", is_baseline(job_.method)},
                                 {"drives", drives_report(drives_, alignment.drives)},
                                 {"hole", hole_report(frames)},
                                 {"map", map ? map_report(*map) : nlohmann::json()},
                                 {"cost", cost_report(progress_, clock, open_.size())},
                                 {"warnings", progress_.warnings()},
                                 {"frames", frames}};
  write_file(out / "report.json", report.dump(1) + "\n");
  return report.dump(1);
}

}  // namespace dvi::pipeline
