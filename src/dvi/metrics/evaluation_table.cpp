#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "dvi/metrics/evaluation.h"

namespace dvi::metrics {
namespace {

std::string number(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

std::string span(const std::optional<Intervals>& intervals) {
  return intervals ? fmt::format("{:.2f}..{:.2f}", intervals->psnr[0], intervals->psnr[1]) : "-";
}

std::string row(const char* title, const std::string& share, const Figures& f) {
  return fmt::format("{:<13}{:>8}{:>8}{:>8}{:>8}{:>8}", title, share, number(f.mae, 2), number(f.rmse, 2), number(f.psnr, 2),
                     number(f.ssim, 3));
}

std::string rows(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<13}{:>8}{:>8}{:>8}{:>8}{:>8}{:>11}{:>9}{:>11}{:>15}\n", "", "share", "MAE", "RMSE", "PSNR",
                                 "SSIM", "sharpness", "flicker", "misplaced", "PSNR, 95 %");
  for (const Origin origin : kOrigins) {
    const Figures& f = evaluation.total[origin];
    text += row(name(origin), number(100 * f.share, 1) + " %", f) +
            fmt::format("{:>11}{:>9}{:>11}{:>15}\n", number(f.sharpness, 2), number(f.flicker, 2), number(f.misplaced_px, 2),
                        span(evaluation.intervals[static_cast<std::size_t>(origin)]));
  }
  return text;
}

std::string line(const Calibration& confidence) {
  return fmt::format(
      "confidence {:.3f} on average, {:.3f} of the pixels within {} gray levels: calibration error {:.3f}, AUSE {}\n",
      confidence.mean, confidence.within, Calibration::kWithin, confidence.ece, number(confidence.ause, 3));
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

std::string table(const Evaluation& evaluation) {
  std::string text = rows(evaluation);
  text += fmt::format("{} frames, {} pixels scored\n", evaluation.frames.size(), evaluation.total[Origin::all].pixels);
  if (!evaluation.unscored.empty())
    text += fmt::format("left out, no pixel to score: {}\n", fmt::join(evaluation.unscored, " "));
  if (const auto& confidence = evaluation.confidence.front()) text += line(*confidence);
  text += fmt::format("per million hole pixels: {:.0f} flash (of the scene round the holes: {:.0f}), {:.0f} overshoot\n",
                      evaluation.artifacts.flash_ppm(), evaluation.artifacts.ring_flash_ppm(),
                      evaluation.artifacts.overshoot_ppm());
  text += "\n" + row("whole frame", "", evaluation.whole_frame) + "   where untouched pixels count as exact\n";
  for (const ExternalEvaluation& external : evaluation.external)
    text += "\n" + external.name + "\n" + table(external.evaluation);
  return text;
}

}  // namespace dvi::metrics
