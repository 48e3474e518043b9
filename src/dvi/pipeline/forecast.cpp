#include "dvi/pipeline/forecast.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"
#include "dvi/io/write_image.h"
#include "dvi/pipeline/make_map.h"
#include "dvi/pipeline/make_views.h"
#include "dvi/pipeline/report_json.h"  // IWYU pragma: keep
#include "dvi/pipeline/rig.h"

namespace dvi::pipeline {
namespace {

constexpr int kCoarseFrom = 640;  // px of width from which every second pixel tells enough

std::string row(const std::string& name, const std::string& image, const audit::HoleShares& hole) {
  return fmt::format("{:<20}{:>10}{:>14.1f}{:>18.1f}{:>14.1f}", name, image, 100 * hole.copied, 100 * hole.copied_elsewhere,
                     100 * hole.never_seen);
}

}  // namespace

std::string ForecastReport::table() const {
  std::string text =
      fmt::format("{:<20}{:>10}{:>14}{:>18}{:>14}\n", "% of", "image", "hole: seen", "by other drives", "never seen");
  for (const FrameForecastReport& frame : frames)
    text += row(frame.name, fmt::format("{:.1f}", 100 * frame.image_share), frame.hole) + "\n";
  return text + row("all", "", hole);
}

std::string to_json(const ForecastReport& report) { return json_text(report); }

ForecastReport forecast_holes(const Recordings& drives, const Poses& poses, const Masks& masks, const Job& job,
                              Progress& progress) {
  const Views views = make_views(drives, poses, masks, progress);
  const map::StaticMap map = build_map(drives, poses, masks, job.options.map, progress);
  const Drive& target = drives.front().drive;
  const int step = target.camera.width < kCoarseFrom ? 1 : 2;
  progress.begin("forecast", views.of_sequence(0).second);
  const audit::Forecast found = audit::forecast(views, map, job.options.depth, job.options.sample, step, progress.tick());
  progress.end();
  ForecastReport report{found.total, {}};
  std::vector<int> numbers;
  for (const audit::FrameForecast& f : found.frames) {
    const Frame& frame = target.frames[views[f.view].frame];
    report.frames.push_back({frame.number, frame.name, f.image_share, f.hole});
    numbers.push_back(frame.number);
  }
  if (!job.out.empty()) {
    make_folder(job.out);
    io::write_png(fs::path(job.out) / "forecast.png", audit::forecast_chart(found, numbers));
  }
  return report;
}

ForecastReport forecast_holes(const Job& job, Progress& progress) {
  const Recordings drives = with_other_cameras(open_recordings(job, MaskNeed::required, progress), job, progress);
  const Poses poses = estimate_poses(drives, job, progress);
  return forecast_holes(drives, poses, find_masks(drives, poses, job, progress), job, progress);
}

}  // namespace dvi::pipeline
