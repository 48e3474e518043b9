#include "dvi/commands/estimate_coverage.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/make_views.h"
#include "dvi/inputs/rig.h"
#include "dvi/media/write_image.h"
#include "dvi/run/make_map.h"

template <>
struct nlohmann::adl_serializer<dvi::audit::HoleShares> {
  static void to_json(nlohmann::json& json, const dvi::audit::HoleShares& hole) {
    json = {{"copied", hole.copied}, {"copied_elsewhere", hole.copied_elsewhere}, {"unobserved", hole.unobserved}};
  }
};

namespace dvi::commands {
namespace {

constexpr int kMinCoarseWidthPx = 640;  // from this width on, every second pixel is enough

std::string format_row(const std::string& name, const std::string& image, const audit::HoleShares& hole) {
  return fmt::format("{:<20}{:>10}{:>14.1f}{:>18.1f}{:>14.1f}", name, image, 100 * hole.copied, 100 * hole.copied_elsewhere,
                     100 * hole.unobserved);
}

}  // namespace

std::string CoverageReport::table() const {
  std::string text =
      fmt::format("{:<20}{:>10}{:>14}{:>18}{:>14}\n", "% of", "image", "hole: copied", "by other drives", "unobserved");
  for (const FrameCoverageReport& frame : frames)
    text += format_row(frame.name, fmt::format("{:.1f}", 100 * frame.image_share), frame.hole) + "\n";
  return text + format_row("all", "", hole);
}

static void to_json(nlohmann::json& j, const FrameCoverageReport& frame) {
  j = {{"number", frame.number}, {"name", frame.name}, {"image_share", frame.image_share}, {"hole", frame.hole}};
}

void to_json(nlohmann::json& j, const CoverageReport& report) {
  j = {{"schema", "dvi-forecast/1"}, {"hole", report.hole}, {"frames", report.frames}};
}

std::string to_json(const CoverageReport& report) { return json_text(nlohmann::json(report)); }

CoverageReport estimate_coverage(const inputs::Inputs& inputs, const job::Job& job, Progress& progress) {
  const Views views = inputs::make_views(inputs, progress);
  const map::StaticMap map = run::build_map(inputs, job.options.map, progress);
  const Drive& target = inputs.drives.front().drive;
  const int step = target.camera.width < kMinCoarseWidthPx ? 1 : 2;
  progress.begin("forecast", views.targets());
  const audit::Coverage found =
      audit::predict_coverage(views, map, {job.options.depth, job.options.sample, step}, progress.tick());
  progress.end();
  CoverageReport report{found.total, {}};
  std::vector<int> numbers;
  for (const audit::FrameCoverage& f : found.frames) {
    const Frame& frame = target.frames[views[f.view].frame];
    report.frames.push_back({frame.number, frame.name, f.image_share, f.hole});
    numbers.push_back(frame.number);
  }
  if (!job.out.empty()) {
    make_folder(job.out);
    media::write_png(fs::path(job.out) / "forecast.png", audit::draw_coverage_chart(found, numbers));
  }
  return report;
}

CoverageReport estimate_coverage(const job::Job& job, Progress& progress) {
  job::require_one_camera(job.read.camera, "dvi forecast");
  const inputs::Recordings drives =
      inputs::add_other_cameras(inputs::open_recordings(job, inputs::MaskNeed::required, progress), job, progress);
  const inputs::Poses poses = inputs::estimate_poses(drives, job, progress);
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  return estimate_coverage({drives, poses, masks}, job, progress);
}

}  // namespace dvi::commands
