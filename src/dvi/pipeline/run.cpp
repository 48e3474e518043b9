#include "dvi/pipeline/run.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/hash.h"
#include "dvi/core/threads.h"
#include "dvi/core/version.h"
#include "dvi/pipeline/fill.h"
#include "dvi/pipeline/map_files.h"
#include "dvi/pipeline/open.h"
#include "dvi/pipeline/report.h"
#include "dvi/pipeline/result_folder.h"
#include "dvi/pipeline/result_media.h"

namespace dvi {
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
  print.add(kVersion);
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

nlohmann::json sources_json(const Views& views, const std::vector<OpenDrive>& drives) {
  nlohmann::json sources = nlohmann::json::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Drive& drive = drives[static_cast<std::size_t>(views[i].drive)].drive;
    const Frame& frame = drive.frames[views[i].frame];
    sources.push_back({{"number", i},
                       {"drive", fs::absolute(drive.path).lexically_normal().string()},
                       {"camera", drive.camera_name},
                       {"frame", frame.name},
                       {"file", fs::absolute(frame.file).lexically_normal().string()},
                       {"exposure_gain", {1.0, 1.0, 1.0}}});
  }
  return {{"schema", "dvi-sources/1"}, {"sources", sources}};
}

std::vector<std::size_t> unfinished(const ResultFolder& result, const std::vector<std::string>& names) {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!result.is_finished(names[i])) open.push_back(i);
  return open;
}

}  // namespace

std::string run(const Job& job, Progress& progress) {
  const bool flat = is_baseline(job.method);  // images and masks only: no poses, no map
  const std::vector<OpenDrive> drives = flat ? open_images(job, progress) : open_drives(job, MaskNeed::required, progress);
  const Drive& target = drives.front().drive;
  Views views = flat ? make_unposed_views(drives) : make_views(drives, progress);
  const std::vector<std::string> names = frame_names(views, target);
  ResultFolder result(job.out, identity_of(drives), fingerprint_of(job, drives), job.force);
  const std::vector<std::size_t> open = unfinished(result, names);
  if (open.empty() && fs::exists(result.path() / "report.json")) {
    progress.note("every frame is finished already: nothing to do");
    return read_file(result.path() / "report.json");
  }

  verify(drives, progress);
  CpuClock clock;
  StaticMap map;
  std::vector<ViewAlignment> alignment(views.size());
  std::optional<Depths> depths;
  FillFrame fill_frame;
  if (flat) {
    fill_frame = baseline(job.method, views, job.options.flow, clock);
  } else {
    progress.begin("map", scan_count(map_inputs(drives)));
    map = build_map(map_inputs(drives), job.options.map, progress.tick());
    if (map.points.empty()) progress.warn("the map is empty: no scan left a static point, nothing can be copied");
    progress.begin("align", job.options.align.enabled ? views.size() * static_cast<std::size_t>(job.options.align.passes) : 0);
    alignment = align(views, map, job.options.align, progress.tick());
    depths.emplace(map, views, job.options.depth, clock);
    fill_frame = Filler(views, *depths, job.options, clock);
  }

  Smoother smoother(fill_frame, 0, names.size(), job.options.smooth, clock);
  progress.begin("fill", open.size());
  const std::size_t block_size = static_cast<std::size_t>(thread_count());
  for (std::size_t at = 0; at < open.size(); at += block_size) {
    const std::vector<std::size_t> block(open.begin() + static_cast<std::ptrdiff_t>(at),
                                         open.begin() + static_cast<std::ptrdiff_t>(std::min(at + block_size, open.size())));
    const std::vector<FilledView> finished = smoother.finish(block);
    parallel_for(block.size(), [&](std::size_t i) {
      const Frame& frame = target.frames[views[block[i]].frame];
      const nlohmann::json record = frame_report(frame, finished[i], alignment[block[i]]);
      clock.time("write", [&] { result.write_frame(frame.name, finished[i].frame, record.dump(1)); });
      progress.advance();
    });
  }

  result.remove_others(names);
  write_file(result.path() / "sources.json", sources_json(views, drives).dump(1) + "\n");
  if (flat)
    fs::remove_all(result.path() / "map");  // left by another method
  else
    write_map_files(result.path() / "map", map, views, target, map_report(map));
  write_media(result.path(), target, names, job.options.video, progress);
  progress.end();
  Job resolved = job;
  resolved.out = fs::absolute(job.out).lexically_normal().string();
  write_file(result.path() / "dvi.toml", resolved.table().dump_toml());

  std::vector<nlohmann::json> frames;
  for (const std::string& name : names) frames.push_back(nlohmann::json::parse(result.frame_record(name)));
  const nlohmann::json report = {{"schema", "dvi-report/1"},
                                 {"version", kVersion},
                                 {"method", job.method},
                                 {"baseline", flat},
                                 {"drives", drives_report(drives)},
                                 {"hole", hole_report(frames)},
                                 {"map", flat ? nlohmann::json() : map_report(map)},
                                 {"cost", cost_report(progress, clock, open.size())},
                                 {"warnings", progress.warnings()},
                                 {"frames", frames}};
  write_file(result.path() / "report.json", report.dump(1) + "\n");
  return report.dump(1);
}

}  // namespace dvi
