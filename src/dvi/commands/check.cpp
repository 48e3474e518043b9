#include "dvi/commands/check.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/commands/check_pictures.h"
#include "dvi/commands/estimate_coverage.h"
#include "dvi/core/json_text.h"
#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/diagnostics/check_scan_times.h"
#include "dvi/inputs/check_setup.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/inputs/mask_sources.h"
#include "dvi/inputs/stretches.h"
#include "dvi/objects/removed_objects.h"
#include "dvi/result/stage_json.h"

namespace dvi::commands {
namespace {

double median_step_s(std::vector<std::int64_t> times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(1e-9 * static_cast<double>(times[i] - times[i - 1]));
  return median(std::move(steps));
}

template <class Stamped>
double rate_hz(const std::vector<Stamped>& items) {
  std::vector<std::int64_t> times;
  for (const Stamped& item : items) times.push_back(item.time_ns);
  const double step_s = median_step_s(times);
  return step_s > 0 ? 1 / step_s : 0;
}

double path_length_m(const Drive& drive, const Trajectory& trajectory) {
  const std::int64_t first = drive.frames.front().time_ns, last = drive.frames.back().time_ns;
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : trajectory.poses())
    if (pose.time_ns >= first && pose.time_ns <= last) poses.push_back(pose);
  return inputs::path_length_m(poses);
}

/// The masked share of each image, and the number of points of each scan.
struct Contents {
  std::vector<double> masked, points;
};

Contents measure_contents(const Drive& drive, const Lazy<cv::Mat1b>& masks) {
  Contents out;
  out.masked.resize(drive.frames.size());
  out.points.resize(drive.scan_headers.size());
  parallel_for(out.masked.size(), [&](std::size_t i) {
    const auto mask = masks[i];
    out.masked[i] = static_cast<double>(std::count_if(mask->begin(), mask->end(), [](uchar m) { return m != 0; })) /
                    static_cast<double>(mask->total());
  });
  parallel_for(out.points.size(), [&](std::size_t i) { out.points[i] = static_cast<double>(drive.scans[i]->size()); });
  return out;
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::map<std::string, std::size_t> count_tracks_by_class(const inputs::Recording& open) {
  std::set<std::pair<std::string, int>> tracks;
  std::map<std::string, std::size_t> out;
  if (!open.masks_from.contains(MaskSource::labels)) return out;
  for (const Frame& frame : open.drive.frames)
    for (const Label& label : frame.labels)
      if (label.track < 0 || tracks.emplace(label.type, label.track).second) ++out[label.type];
  return out;
}

CheckReport make_report(const inputs::Recording& open, const inputs::PoseChoice& choice, const objects::Masks& masks,
                        job::Method method) {
  const Drive& drive = open.drive;
  const Contents found = measure_contents(drive, masks.front().images);
  const Trajectory& poses = inputs::trajectory_of(drive, choice);
  CheckReport out{.path = drive.path.string(),
                  .format = drive.format,
                  .camera_name = drive.camera_name,
                  .camera_names = drive.camera_names,
                  .topics = drive.topics,
                  .camera = drive.camera,
                  .frames = drive.frames.size(),
                  .first_frame = drive.frames.front().number,
                  .last_frame = drive.frames.back().number,
                  .frame_rate_hz = rate_hz(drive.frames),
                  .scans = drive.scan_headers.size(),
                  .scan_rate_hz = rate_hz(drive.scan_headers),
                  .mean_points = mean(found.points),
                  .path_m = path_length_m(drive, poses),
                  .poses_from = to_string(choice.from),
                  .poses = std::make_shared<const nlohmann::json>(result::poses_json(drive, choice)),
                  .mask_source = inputs::mask_source(open),
                  .objects = count_tracks_by_class(open),
                  .mean_masked = mean(found.masked),
                  .largest_masked = found.masked.empty() ? 0.0 : *std::max_element(found.masked.begin(), found.masked.end()),
                  .warnings = drive.warnings,
                  .pictures = {},
                  .coverage = {}};
  for (const Frame& frame : drive.frames) out.frames_with_pose += poses.at(frame.time_ns) ? 1 : 0;
  out.warnings.insert(out.warnings.end(), choice.warnings.begin(), choice.warnings.end());
  if (poses.empty()) out.warnings.emplace_back("no poses: give --poses FILE");
  if (!drive.has_geometry())
    out.warnings.emplace_back(
        "no scans and no map: nothing can be copied; --method flow, telea, and ns only need images and masks");
  if (open.masks_from.empty() && drive.scan_headers.empty())
    out.warnings.emplace_back("neither masks, labels, nor scans show the objects to remove: give --masks DIR or --masks FILE");
  if (!drive.map.empty()) out.map_points = drive.map[0]->points.size();
  out.ready = job::is_baseline(method) ? !inputs::without_scans(open.masks_from).empty()
                                       : out.frames_with_pose > 0 && drive.has_geometry() &&
                                             (!open.masks_from.empty() || !drive.scan_headers.empty());
  return out;
}

// Returns whether moving objects are one more source of masks in a run.
bool adds_moving_objects(const MaskSources& sources, const std::vector<job::MasksFrom>& named) {
  using Kind = job::MasksFrom::Kind;
  const bool is_given = sources.contains(MaskSource::files) || sources.contains(MaskSource::labels);
  return !sources.empty() && std::any_of(named.begin(), named.end(), [&](const job::MasksFrom& from) {
    return from.kind == Kind::found || (from.kind == Kind::automatic && !is_given);
  });
}

// A report of one drive does not repeat its name in each warning.
std::string remove_name(const std::string& warning, const inputs::Recording& open) {
  const std::string name = inputs::name_of(open) + ": ";
  return warning.starts_with(name) ? warning.substr(name.size()) : warning;
}

std::string describe_masks(const CheckReport& report) {
  std::vector<std::string> objects;
  for (const auto& [type, count] : report.objects) objects.push_back(fmt::format("{} {}", count, type));
  const std::string what = objects.empty() ? "" : fmt::format(" ({})", fmt::join(objects, ", "));
  if (report.mask_source != "none")
    return fmt::format("from {}{}: {:.1f} % of the image on average, {:.1f} % at most{}", report.mask_source, what,
                       100 * report.mean_masked, 100 * report.largest_masked,
                       report.finds_moving ? "; dvi run also finds moving objects" : "");
  return report.scans > 0 ? "none: dvi run finds moving objects; dvi mask shows them" : "none";
}

std::string describe_geometry(const CheckReport& report) {
  if (report.map_points > 0) return fmt::format("  map      {} points, instead of scans\n", report.map_points);
  return fmt::format("  scans    {}, {:.1f} Hz, {:.0f} points each\n", report.scans, report.scan_rate_hz, report.mean_points);
}

nlohmann::json topics_json(const std::vector<RecordedTopic>& topics) {
  nlohmann::json out = nlohmann::json::array();
  for (const RecordedTopic& topic : topics)
    out.push_back({{"name", topic.name},
                   {"type", topic.type},
                   {"messages", topic.messages},
                   {"rate_hz", topic.rate_hz},
                   {"use", topic.use}});
  return out;
}

}  // namespace

std::string CheckReport::brief() const {
  std::string text = fmt::format(
      "{}\n  format   {}\n  camera   {} ({}x{}, {}fx {:.1f})\n  frames   {} ({}:{}), {:.1f} Hz, {} with pose\n"
      "{}  path     {}\n"
      "  masks    {}\n",
      path, format, camera_name, camera.width, camera.height, camera.is_wide() ? to_string(camera.model) + ", " : "", camera.fx,
      frames, first_frame, last_frame, frame_rate_hz, frames_with_pose, describe_geometry(*this),
      frames_with_pose > 0 ? fmt::format("{:.1f} m, by {} poses", path_m, poses_from) : "unknown: no poses",
      describe_masks(*this));
  if (place)
    text += fmt::format("  gps      {} fixes, half of them within {:.2f} m of the path\n", place->fixes, place->residual_m);
  for (const RecordedTopic& topic : topics)
    text += fmt::format("  topic    {} ({}): {} messages, {:.1f} Hz{}\n", topic.name, topic.type, topic.messages, topic.rate_hz,
                        topic.use.empty() ? "" : ": " + topic.use);
  if (coverage)
    text += fmt::format(
        "  coverage {:.1f} % of the hole is observed by sources, {:.1f} % is unobserved (--unobserved sets its filling)\n",
        100 * (1 - coverage->hole.unobserved), 100 * coverage->hole.unobserved);
  for (const std::string& picture : pictures) text += fmt::format("  picture  {}\n", picture);
  for (const std::string& warning : warnings) text += fmt::format("  warning  {}\n", warning);
  return text + (ready ? "  ready for dvi run" : "  not ready for dvi run: see the warnings");
}

std::string to_json(const CheckReport& r) {
  nlohmann::json j = {
      {"schema", "dvi-check/1"},
      {"path", r.path},
      {"format", r.format},
      {"camera",
       {{"name", r.camera_name},
        {"all", r.camera_names},
        {"width", r.camera.width},
        {"height", r.camera.height},
        {"model", to_string(r.camera.model)},
        {"fx", r.camera.fx},
        {"fy", r.camera.fy},
        {"cx", r.camera.cx},
        {"cy", r.camera.cy}}},
      {"frames",
       {{"count", r.frames},
        {"first", r.first_frame},
        {"last", r.last_frame},
        {"rate_hz", r.frame_rate_hz},
        {"with_pose", r.frames_with_pose}}},
      {"scans", {{"count", r.scans}, {"rate_hz", r.scan_rate_hz}, {"mean_points", r.mean_points}}},
      {"map", {{"points", r.map_points}}},
      {"path_m", r.path_m},
      {"poses", *r.poses},
      {"masks",
       {{"source", r.mask_source}, {"mean_share", r.mean_masked}, {"largest_share", r.largest_masked}, {"objects", r.objects}}},
      {"topics", topics_json(r.topics)},
      {"pictures", r.pictures},
      {"ready", r.ready},
      {"warnings", r.warnings}};
  if (r.place) j["place"] = result::place_json(*r.place);
  j["masks"]["finds_moving"] = r.finds_moving;
  if (r.coverage) j["coverage"] = *r.coverage;
  return json_text(j);
}

CheckReport check(const job::Job& given, bool with_coverage, Progress& progress) {
  job::Job job = given;
  // Shadows take a sixth of the time of a check, and do not help to decide whether the recording is valid.
  job.options.masks.shadows = given.options.masks.shadows && with_coverage;
  job::require_one_camera(job.read.camera, "dvi check");
  const inputs::Recordings drives{inputs::open_recording(job.target, job.read, inputs::MaskNeed::optional, progress)};
  const Drive& drive = drives.front().drive;
  const std::optional<std::string> memory_warning = inputs::bound_memory(job, drives);
  if (memory_warning) progress.warn(*memory_warning);
  const std::vector<std::string> range_warnings = inputs::verify(drives, job, progress);
  inputs::PoseChoice choice;
  if (!drive.poses.empty() || !drive.scan_headers.empty())
    choice = inputs::choose_poses(drive, job.read.poses, job.options.odometry, progress);
  const bool posed = !inputs::trajectory_of(drive, choice).empty();
  const inputs::Poses poses = posed ? inputs::transform_to_target_world(drives, {choice}) : inputs::use_given_poses(drives);
  const std::size_t known = progress.warnings().size();
  const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
  CheckReport report = make_report(drives.front(), choice, masks, job.method);
  report.finds_moving = !drive.scan_headers.empty() && adds_moving_objects(drives.front().masks_from, job.read.masks);
  const auto removed = objects::list_removed_objects(inputs::evidence_of(drives.front(), poses.front().world_from_lidar),
                                                     masks.front().objects, job.options.masks);
  for (const std::string& warning : objects::describe_incomplete(objects::count_objects(removed), report.mask_source))
    report.warnings.push_back(warning);
  const std::vector<std::string> warned = progress.warnings();
  for (std::size_t i = known; i < warned.size(); ++i) report.warnings.push_back(remove_name(warned[i], drives.front()));
  report.place = find_place(poses.front().world_from_lidar, drive.fixes);
  if (memory_warning) report.warnings.push_back(*memory_warning);
  report.warnings.insert(report.warnings.end(), range_warnings.begin(), range_warnings.end());
  const std::vector<std::string> contradictions = inputs::check_setup({drives, poses, masks}, progress);
  report.warnings.insert(report.warnings.end(), contradictions.begin(), contradictions.end());
  for (const std::string& warning : diagnostics::check_scan_times(drive, inputs::trajectory_of(drive, choice))) {
    progress.warn(drive.path.filename().string() + ": " + warning);
    report.warnings.push_back(warning);
  }
  if (!job.out.empty()) report.pictures = write_check_pictures(job.out, drive, inputs::trajectory_of(drive, choice));
  if (with_coverage && report.ready) report.coverage = estimate_coverage({drives, poses, masks}, job, progress);
  return report;
}

}  // namespace dvi::commands
