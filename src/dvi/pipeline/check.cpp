#include "dvi/pipeline/check.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/pipeline/forecast.h"
#include "dvi/pipeline/open.h"

namespace dvi::pipeline {
namespace {

double median_step(std::vector<std::int64_t> times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(1e-9 * static_cast<double>(times[i] - times[i - 1]));
  return median(std::move(steps));
}

template <class Stamped>
double rate(const std::vector<Stamped>& items) {
  std::vector<std::int64_t> times;
  for (const Stamped& item : items) times.push_back(item.time_ns);
  const double step = median_step(times);
  return step > 0 ? 1 / step : 0;
}

double path_length(const Drive& drive, const Trajectory& trajectory) {
  double length = 0;
  const auto& poses = trajectory.poses();
  const std::int64_t first = drive.frames.front().time_ns, last = drive.frames.back().time_ns;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (poses[i - 1].time_ns >= first && poses[i].time_ns <= last)
      length += (poses[i].world_from_body.t - poses[i - 1].world_from_body.t).norm();
  return length;
}

/// Share of each image that is masked, points of each scan.
struct Contents {
  std::vector<double> masked, points;
};

Contents contents(const OpenDrive& open) {
  Contents out;
  out.masked.resize(open.drive.frames.size());
  out.points.resize(open.drive.sweeps.size());
  parallel_for(out.masked.size(), [&](std::size_t i) {
    const auto mask = open.masks[i];
    out.masked[i] = static_cast<double>(std::count_if(mask->begin(), mask->end(), [](uchar m) { return m != 0; })) /
                    static_cast<double>(mask->total());
  });
  parallel_for(out.points.size(), [&](std::size_t i) { out.points[i] = static_cast<double>(open.drive.scans[i]->size()); });
  return out;
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

nlohmann::json describe(const OpenDrive& open, std::vector<std::string> warnings) {
  const Drive& drive = open.drive;
  const Contents found = contents(open);
  const Trajectory& poses = chosen(drive, open.poses);
  std::size_t posed = 0;
  for (const Frame& frame : drive.frames) posed += poses.at(frame.time_ns) ? 1 : 0;
  const bool masks = !drive.masks.empty() || drive.has_labels();
  if (!masks) warnings.emplace_back("neither masks nor labels: give --masks to say what to remove");
  if (poses.empty()) warnings.emplace_back("no poses: give --poses FILE");
  if (drive.sweeps.empty()) warnings.emplace_back("no scans: nothing can be copied");
  const auto max_masked = std::max_element(found.masked.begin(), found.masked.end());
  return {{"schema", "dvi-check/1"},
          {"path", drive.path.string()},
          {"format", drive.format},
          {"camera",
           {{"name", drive.camera_name},
            {"all", drive.camera_names},
            {"width", drive.camera.width},
            {"height", drive.camera.height},
            {"fx", drive.camera.fx},
            {"fy", drive.camera.fy},
            {"cx", drive.camera.cx},
            {"cy", drive.camera.cy}}},
          {"frames",
           {{"count", drive.frames.size()},
            {"first", drive.frames.front().number},
            {"last", drive.frames.back().number},
            {"rate_hz", rate(drive.frames)},
            {"with_pose", posed}}},
          {"sweeps", {{"count", drive.sweeps.size()}, {"rate_hz", rate(drive.sweeps)}, {"mean_points", mean(found.points)}}},
          {"path_m", path_length(drive, poses)},
          {"poses", poses_report(drive, open.poses)},
          {"masks",
           {{"source", !drive.masks.empty() ? "files"
                       : masks              ? "labels"
                                            : "none"},
            {"mean_share", mean(found.masked)},
            {"largest_share", found.masked.empty() ? 0.0 : *max_masked}}},
          {"ready", masks && posed > 0 && !drive.sweeps.empty()},
          {"warnings", warnings}};
}

std::string text_of(const nlohmann::json& j) {
  const auto& camera = j["camera"];
  const auto& frames = j["frames"];
  const auto& masks = j["masks"];
  std::string text = fmt::format(
      "{}\n  format   {}\n  camera   {} ({}x{}, fx {:.1f})\n  frames   {} ({}:{}), {:.1f} Hz, {} with pose\n"
      "  sweeps   {}, {:.1f} Hz, {:.0f} points each\n  path     {:.1f} m, by {} poses\n"
      "  masks    from {}: {:.1f} % of the image on average, {:.1f} % at most\n",
      j["path"].get<std::string>(), j["format"].get<std::string>(), camera["name"].get<std::string>(),
      camera["width"].get<int>(), camera["height"].get<int>(), camera["fx"].get<double>(), frames["count"].get<int>(),
      frames["first"].get<int>(), frames["last"].get<int>(), frames["rate_hz"].get<double>(), frames["with_pose"].get<int>(),
      j["sweeps"]["count"].get<int>(), j["sweeps"]["rate_hz"].get<double>(), j["sweeps"]["mean_points"].get<double>(),
      j["path_m"].get<double>(), j["poses"]["from"].get<std::string>(), masks["source"].get<std::string>(),
      100 * masks["mean_share"].get<double>(), 100 * masks["largest_share"].get<double>());
  if (j.contains("forecast")) {
    const auto& hole = j["forecast"]["hole"];
    text += fmt::format("  expected {:.1f} % of the hole seen elsewhere, {:.1f} % never\n",
                        100 * (1 - hole["never_seen"].get<double>()), 100 * hole["never_seen"].get<double>());
  }
  for (const auto& warning : j["warnings"]) text += fmt::format("  warning  {}\n", warning.get<std::string>());
  text += j["ready"].get<bool>() ? "  ready for dvi run" : "  not ready for dvi run: see the warnings";
  return text;
}

}  // namespace

CheckReport check(const Job& job, Progress& progress) {
  std::vector<OpenDrive> drives{open_drive(job.target, job.source, MaskNeed::optional, job.options.masks, progress)};
  OpenDrive& open = drives.front();
  verify(drives, progress);
  if (!open.drive.poses.empty() || !open.drive.sweeps.empty())
    open.poses = choose_poses(open.drive, job.source.poses, job.options.odometry, progress);
  nlohmann::json report = describe(open, open.drive.warnings);
  if (report["ready"].get<bool>()) {
    share_world(drives);
    report["forecast"] = forecast_json(drives, job, progress);
  }
  return {report.dump(1), text_of(report)};
}

}  // namespace dvi::pipeline
