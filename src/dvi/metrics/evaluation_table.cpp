#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

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
  }
  return "";
}

std::string format_table(const Evaluation& evaluation) {
  std::string text = format_rows(evaluation);
  text += fmt::format("{} frames, {} pixels scored\n", evaluation.frames.size(), evaluation.total[Origin::all].pixels);
  if (!evaluation.unscored.empty())
    text += fmt::format("frames without scored pixels: {}\n", fmt::join(evaluation.unscored, " "));
  if (const auto& confidence = evaluation.confidence.front()) text += format_confidence(*confidence);
  text += fmt::format("per million hole pixels: {:.0f} flash (in the scene around the holes: {:.0f}), {:.0f} overshoot\n",
                      evaluation.artifacts.flash_ppm(), evaluation.artifacts.ring_flash_ppm(),
                      evaluation.artifacts.overshoot_ppm());
  text += "\n" + format_row("whole frame", "", evaluation.whole_frame) + "   (unchanged pixels count as exact)\n";
  for (const ExternalEvaluation& external : evaluation.external)
    text += "\n" + external.name + "\n" + format_table(external.evaluation);
  return text;
}

}  // namespace dvi::metrics
