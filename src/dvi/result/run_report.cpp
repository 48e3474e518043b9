#include "dvi/result/run_report.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace dvi::result {
namespace {

std::array<double, 3> in_degrees(const Eigen::Vector3d& rotation) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  return {rotation.x() * kDegrees, rotation.y() * kDegrees, rotation.z() * kDegrees};
}

/// Of a source drive that its scans put where it is.
std::optional<RegistrationReport> registration_report(const Drive& drive, const inputs::DrivePoses& poses) {
  if (!poses.placed) return std::nullopt;
  const registration::PlacementFigures& placed = *poses.placed;
  RegistrationReport out{.overlap = placed.overlap,
                         .residual_m = placed.residual_m,
                         .bound_m = placed.bound_m,
                         .bound_deg = placed.bound_deg,
                         .things = placed.landmarks,
                         .things_agree = placed.landmark_inliers,
                         .passed_share = placed.passed_share,
                         .rival = placed.second_best_ratio};
  const Trajectory& trajectory = poses.world_from_lidar;
  const SE3 first = trajectory.at(drive.scan_headers.front().time_ns).value_or(trajectory.poses().front().world_from_body);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.target_from_source[row][column] = first.R(row, column);
    out.target_from_source[row][3] = first.t[row];
  }
  return out;
}

}  // namespace

HoleParts HoleReport::share() const {
  const auto part = [this](std::size_t count) {
    return pixels > 0 ? static_cast<double>(count) / static_cast<double>(pixels) : 0.0;
  };
  HoleParts out{part(copied), part(copied_elsewhere), part(interpolated), part(synthesized), part(empty), 0};
  out.unobserved = out.interpolated + out.synthesized + out.empty;
  return out;
}

HoleReport& HoleReport::operator+=(const HoleReport& other) {
  pixels += other.pixels;
  copied += other.copied;
  copied_elsewhere += other.copied_elsewhere;
  interpolated += other.interpolated;
  synthesized += other.synthesized;
  empty += other.empty;
  return *this;
}

FrameReport frame_report(const Frame& frame, const FilledView& view, const align::ViewAlignment& alignment) {
  std::array<std::size_t, 6> count{};
  for (const uchar kind : view.frame.kind) ++count[std::min<std::size_t>(kind, 5)];
  const auto of = [&](harmonize::Kind kind) { return count[static_cast<std::size_t>(kind)]; };
  const cv::Vec3f& gain = view.frame.gain;
  return {.number = frame.number,
          .name = frame.name,
          .hole = {.pixels = view.frame.kind.total() - of(harmonize::Kind::original),
                   .copied = of(harmonize::Kind::copied),
                   .copied_elsewhere = of(harmonize::Kind::copied_elsewhere),
                   .interpolated = of(harmonize::Kind::interpolated),
                   .synthesized = of(harmonize::Kind::synthesized),
                   .empty = of(harmonize::Kind::empty)},
          .energy = view.energy,
          .alignment = {in_degrees(alignment.rotation),
                        {alignment.position.x(), alignment.position.y(), alignment.position.z()},
                        alignment.offset_before_px,
                        alignment.offset_after_px,
                        alignment.points},
          .exposure_gain = {gain[2], gain[1], gain[0]}};
}

MapReport map_report(const map::StaticMap& map) { return {map.points.size(), map.counts}; }

std::vector<DriveReport> drive_reports(const inputs::Recordings& drives, const inputs::Poses& poses,
                                       const align::Cameras& cameras) {
  const auto alignment = [&](std::size_t sequence) -> std::optional<DriveAlignmentReport> {
    if (sequence >= cameras.sequences.size()) return std::nullopt;
    const align::SequenceAlignment& found = cameras.sequences[sequence];
    return DriveAlignmentReport{found.kept, in_degrees(found.mounting)};
  };
  std::vector<DriveReport> reports;
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Drive& drive = drives[i].drive;
    if (drives[i].rig_of)
      reports[*drives[i].rig_of].other_cameras.push_back({drive.camera_name, inputs::mask_source(drives[i]), drives[i].gray,
                                                          drive.frames.size(), alignment(i), drive.warnings});
    else
      reports.push_back({.path = fs::absolute(drive.path).lexically_normal().string(),
                         .format = drive.format,
                         .camera = drive.camera_name,
                         .frames = drive.frames.size(),
                         .scans = drive.scan_headers.size(),
                         .poses = inputs::poses_report(drive, poses[i].choice),
                         .place = find_place(poses[i].world_from_lidar, drive.fixes),
                         .registration = registration_report(drive, poses[i]),
                         .alignment = alignment(i),
                         .warnings = drive.warnings,
                         .other_cameras = {}});
  }
  return reports;
}

CostReport cost_report(const Progress& progress, const CpuClock& clock, std::size_t frames_made) {
  return {progress.times(), clock.seconds(), frames_made, peak_memory()};
}

CostReport& CostReport::operator+=(const CostReport& other) {
  for (const StageTime& time : other.stages) {
    const auto same = std::find_if(stages.begin(), stages.end(), [&](const StageTime& t) { return t.stage == time.stage; });
    if (same == stages.end()) {
      stages.push_back(time);
    } else {
      same->seconds += time.seconds;
      same->cpu_seconds += time.cpu_seconds;
    }
  }
  for (const auto& [stage, seconds] : other.fill_cpu_seconds) fill_cpu_seconds[stage] += seconds;
  frames_made += other.frames_made;
  peak_memory_bytes = std::max(peak_memory_bytes, other.peak_memory_bytes);
  return *this;
}

namespace {

// ", 12.0 % unobserved (9.0 % synthesized, 3.0 % interpolated)".
std::string unobserved_text(const HoleParts& share) {
  std::string how;
  for (const auto& [part, name] : {std::pair(share.synthesized, "synthesized"), std::pair(share.interpolated, "interpolated"),
                                   std::pair(share.empty, "left black")})
    if (part > 0) how += fmt::format("{}{:.1f} % {}", how.empty() ? "" : ", ", 100 * part, name);
  return fmt::format(", {:.1f} % unobserved", 100 * share.unobserved) + (how.empty() ? "" : " (" + how + ")");
}

}  // namespace

std::string RunReport::brief(const std::string& out) const {
  const HoleParts share = hole.share();
  std::string text = fmt::format("{} frames, {} hole pixels: {:.1f} % copied", frames.size(), hole.pixels, 100 * share.copied);
  if (share.copied_elsewhere > 0) text += fmt::format(", {:.1f} % from other cameras or drives", 100 * share.copied_elsewhere);
  text += unobserved_text(share);
  const auto part = [&] { return static_cast<double>(standing->pixels) / static_cast<double>(hole.pixels); };
  if (standing && hole.pixels > 0 && part() > 0.5)
    text += fmt::format("\n{} of {} removed tracks stand; they are {:.0f} % of the hole; --remove moving would keep them",
                        standing->standing, standing->tracks, 100 * part());
  for (const DriveReport& drive : drives)
    if (const std::optional<RegistrationReport>& placed = drive.registration)
      text += fmt::format("\n{}: {:.0f} % of its scans overlap; placed to {:.1f} cm and {:.2f} degrees (95 %)",
                          fs::path(drive.path).filename().string(), 100 * placed->overlap, 100 * placed->bound_m,
                          placed->bound_deg);
  double cpu = 0;
  for (const StageTime& stage : cost.stages) cpu += stage.cpu_seconds;
  text += fmt::format("\n{:.1f} CPU s a frame, peak memory {:.0f} MB",
                      cpu / static_cast<double>(std::max<std::size_t>(1, cost.frames_made)),
                      static_cast<double>(cost.peak_memory_bytes) / 1e6);
  return text + fmt::format(
                    "\n  {0}/report.html  what was removed and how well it went: open it in a browser\n"
                    "  {0}/frames       the drive without its traffic\n  {0}/video.mp4    as a video\n"
                    "  {0}/compare.mp4  input above result\n  {0}/contact.png  some frames on one sheet\n"
                    "  {0}/report.json  all figures",
                    out);
}

}  // namespace dvi::result
