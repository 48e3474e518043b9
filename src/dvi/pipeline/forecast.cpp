#include "dvi/pipeline/forecast.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/audit/forecast.h"
#include "dvi/io/write_image.h"
#include "dvi/pipeline/make_map.h"

namespace dvi::pipeline {
namespace {

constexpr int kCoarseFrom = 640;  // px of width from which every second pixel tells enough

audit::Forecast make_forecast(const std::vector<OpenDrive>& drives, const Views& views, const Job& job, Progress& progress) {
  const map::StaticMap map = map_drives(drives, job.options.map, progress);
  const int step = drives.front().drive.camera.width < kCoarseFrom ? 1 : 2;
  progress.begin("forecast", views.of_drive(0).second);
  audit::Forecast out = audit::forecast(views, map, job.options.depth, job.options.sample, step, progress.tick());
  progress.end();
  return out;
}

nlohmann::json json_of(const audit::HoleShares& hole) {
  return {{"copied", hole.copied}, {"copied_elsewhere", hole.copied_elsewhere}, {"never_seen", hole.never_seen}};
}

nlohmann::json json_of(const audit::Forecast& forecast, const Views& views, const Drive& target) {
  nlohmann::json frames = nlohmann::json::array();
  for (const audit::FrameForecast& f : forecast.frames) {
    const Frame& frame = target.frames[views[f.view].frame];
    frames.push_back(
        {{"number", frame.number}, {"name", frame.name}, {"image_share", f.image_share}, {"hole", json_of(f.hole)}});
  }
  return {{"schema", "dvi-forecast/1"}, {"hole", json_of(forecast.total)}, {"frames", frames}};
}

std::string text_of(const nlohmann::json& j) {
  const auto row = [](const std::string& name, const std::string& image, const nlohmann::json& hole) {
    return fmt::format("{:<20}{:>10}{:>14.1f}{:>18.1f}{:>14.1f}", name, image, 100 * hole["copied"].get<double>(),
                       100 * hole["copied_elsewhere"].get<double>(), 100 * hole["never_seen"].get<double>());
  };
  std::string text =
      fmt::format("{:<20}{:>10}{:>14}{:>18}{:>14}\n", "% of", "image", "hole: seen", "by other drives", "never seen");
  for (const auto& frame : j["frames"])
    text += row(frame["name"], fmt::format("{:.1f}", 100 * frame["image_share"].get<double>()), frame["hole"]) + "\n";
  return text + row("all", "", j["hole"]);
}

}  // namespace

nlohmann::json forecast_json(const std::vector<OpenDrive>& drives, const Job& job, Progress& progress) {
  const Views views = make_views(drives, progress);
  return json_of(make_forecast(drives, views, job, progress), views, drives.front().drive);
}

ForecastReport forecast_holes(const Job& job, Progress& progress) {
  std::vector<OpenDrive> drives = open_drives(job, MaskNeed::required, progress);
  find_poses(drives, job, progress);
  const Views views = make_views(drives, progress);
  const audit::Forecast found = make_forecast(drives, views, job, progress);
  if (!job.out.empty()) {
    make_folder(job.out);
    io::write_png(fs::path(job.out) / "forecast.png", audit::forecast_chart(found));
  }
  const nlohmann::json report = json_of(found, views, drives.front().drive);
  return {report.dump(1), text_of(report)};
}

}  // namespace dvi::pipeline
