#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {
namespace {

std::string format_number(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

std::string format_interval(const std::optional<Intervals>& intervals) {
  return intervals ? fmt::format("{:.2f}..{:.2f}", intervals->psnr[0], intervals->psnr[1]) : "-";
}

std::string format_row(const char* title, const std::string& share, const Figures& f) {
  return fmt::format("{:<13}{:>8}{:>8}{:>8}{:>8}{:>8}", title, share, format_number(f.mae, 2), format_number(f.rmse, 2),
                     format_number(f.psnr, 2), format_number(f.ssim, 3));
}

std::string format_rows(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<13}{:>8}{:>8}{:>8}{:>8}{:>8}{:>11}{:>9}{:>12}{:>15}\n", "", "share", "MAE", "RMSE", "PSNR",
                                 "SSIM", "sharpness", "flicker", "pos. error", "PSNR, 95 %");
  for (const Origin origin : kOrigins) {
    const Figures& f = evaluation.total[origin];
    if (origin == Origin::imported && f.pixels == 0) continue;
    text += format_row(name(origin), format_number(100 * f.share, 1) + " %", f) +
            fmt::format("{:>11}{:>9}{:>12}{:>15}\n", format_number(f.sharpness, 2), format_number(f.flicker, 2),
                        format_number(f.position_error_px, 2),
                        format_interval(evaluation.intervals[static_cast<std::size_t>(origin)]));
  }
  return text;
}

std::string format_confidence(const Calibration& confidence) {
  return fmt::format(
      "confidence {:.3f} on average, {:.3f} of the pixels within {} gray levels: calibration error {:.3f}, AUSE {}\n",
      confidence.mean, confidence.within, Calibration::kMaxDifference, confidence.ece, format_number(confidence.ause, 3));
}

// Formats the scores against the truth.
std::string format_scores(const Evaluation& evaluation) {
  std::string text = format_rows(evaluation);
  text += fmt::format("{} frames, {} pixels scored\n", evaluation.frames.size(), evaluation.total[Origin::all].pixels);
  if (!evaluation.unscored.empty())
    text += fmt::format("frames without scored pixels: {}\n", fmt::join(evaluation.unscored, " "));
  if (const auto& confidence = evaluation.confidence.front()) text += format_confidence(*confidence);
  return text;
}

std::string format_number(const std::optional<double>& value, int digits) {
  return value ? format_number(*value, digits) : "-";
}

std::string format_look(const Look& look) {
  const LookSums& sums = look.total;
  std::string text = fmt::format(
      "look of {} unobserved pixels: {} (texture {} + boundary {}; 0: as their surroundings), {} % blank, color {}\n",
      sums.pixels, format_number(sums.look(), 2), format_number(sums.texture(), 2), format_number(sums.boundary(), 2),
      format_number(100 * sums.blank().value_or(0), 1), format_number(sums.color(), 1));
  const std::vector<LookPart> worst = look.find_worst_parts();
  for (std::size_t i = 0; i < worst.size(); ++i)
    text += fmt::format("{}{} at {},{} ({:.2f})", i == 0 ? "  worst parts: frame " : ", ", worst[i].frame, worst[i].box.x,
                        worst[i].box.y, *worst[i].sums.look());
  return text + (worst.empty() ? "" : "\n");
}

std::string format_percent(double share) { return fmt::format("{:.2f} %", 100 * share); }

// Formats the tracks that are refilled most.
std::string format_tracks(std::vector<GhostTrack> tracks) {
  constexpr std::size_t kMaxRows = 10;
  std::erase_if(tracks, [](const GhostTrack& track) { return track.refilled == 0; });
  if (tracks.empty()) return {};
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const GhostTrack& a, const GhostTrack& b) { return a.refilled > b.refilled; });
  tracks.resize(std::min(tracks.size(), kMaxRows));
  std::string text = fmt::format("  {:>7}  {:<12}{:>12}{:>23}\n", "track", "class", "removed px", "refilled by objects");
  for (const GhostTrack& track : tracks)
    text += fmt::format("  {:>7}  {:<12}{:>12}{:>23}\n", track.track, track.type, track.removed,
                        format_percent(track.refilled_share()));
  return text;
}

std::string format_ghosts(const Ghosts& ghosts) {
  std::string text = fmt::format("ghosts: {} of {} copied pixels show one of {} stationary labeled objects; {} lie in one\n",
                                 format_percent(ghosts.total.ghost_share()), ghosts.total.copied, ghosts.tracks.size(),
                                 format_percent(ghosts.total.in_map_share()));
  if (ghosts.unjudged > 0)
    text += fmt::format("  {} further copied pixels are from other drives, or from frames without a pose\n", ghosts.unjudged);
  const std::vector<GhostFrame> worst = ghosts.find_worst_frames();
  for (std::size_t i = 0; i < worst.size(); ++i)
    text += fmt::format("{}{} ({} px)", i == 0 ? "  most in the frames " : ", ", worst[i].name, worst[i].counts.ghosts);
  return text + (worst.empty() ? "" : "\n") + format_tracks(ghosts.tracks);
}

std::string format_counts(const char* title, const PointCounts& counts) {
  return fmt::format("  {:<11}{:>11}{:>11}{:>9}{:>9}{:>9}{:>9}\n", title, counts.statics, counts.dynamics,
                     format_number(counts.static_accuracy(), 4), format_number(counts.dynamic_accuracy(), 4),
                     format_number(counts.associated_accuracy(), 4), format_number(counts.dynamic_iou(), 4));
}

std::string format_points(const PointScores& points) {
  return fmt::format("points of {} scans:\n  {:<11}{:>11}{:>11}{:>9}{:>9}{:>9}{:>9}\n", points.scans, "", "static", "dynamic",
                     "SA", "DA", "AA", "IoU") +
         format_counts("in view", points.in_view) + format_counts("all", points.all);
}

}  // namespace

const char* name(Origin origin) {
  switch (origin) {
    case Origin::all:
      return "all";
    case Origin::copied:
      return "copied";
    case Origin::interpolated:
      return "interpolated";
    case Origin::synthesized:
      return "synthesized";
    case Origin::empty:
      return "empty";
    case Origin::imported:
      return "imported";
  }
  return "";
}

std::string format_table(const Evaluation& evaluation) {
  std::string text = evaluation.has_truth ? format_scores(evaluation) : "";
  text += fmt::format("per million hole pixels: {:.0f} flash (in the scene around the holes: {:.0f}), {:.0f} overshoot\n",
                      evaluation.artifacts.flash_ppm(), evaluation.artifacts.ring_flash_ppm(),
                      evaluation.artifacts.overshoot_ppm());
  if (evaluation.look) text += format_look(*evaluation.look);
  if (evaluation.ghosts) text += format_ghosts(*evaluation.ghosts);
  if (!evaluation.ghosts_left_out.empty()) text += "ghosts: not known, because " + evaluation.ghosts_left_out + "\n";
  if (evaluation.points) text += format_points(*evaluation.points);
  if (evaluation.has_truth)
    text += "\n" + format_row("whole frame", "", evaluation.whole_frame) + "   (unchanged pixels count as exact)\n";
  for (const ExternalEvaluation& external : evaluation.external)
    text += "\n" + external.name + "\n" + format_table(external.evaluation);
  return text;
}

}  // namespace dvi::metrics
