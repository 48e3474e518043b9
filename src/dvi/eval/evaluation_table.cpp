#include <cmath>
#include <string>

#include <fmt/format.h>

#include "dvi/eval/evaluation.h"

namespace dvi {
namespace {

std::string number(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

std::string row(const char* origin, const Figures& f) {
  return fmt::format("{:<13}{:>8}{:>8}{:>8}{:>8}{:>8}{:>11}{:>9}{:>11}\n", origin, number(100 * f.share, 1) + " %",
                     number(f.mae, 2), number(f.rmse, 2), number(f.psnr, 2), number(f.ssim, 3), number(f.sharpness, 2),
                     number(f.flicker, 2), number(f.misplaced_px, 2));
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
    case Origin::synthesised:
      return "synthesised";
    case Origin::empty:
      return "empty";
  }
  return "";
}

std::string table(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<13}{:>8}{:>8}{:>8}{:>8}{:>8}{:>11}{:>9}{:>11}\n", "", "share", "MAE", "RMSE", "PSNR",
                                 "SSIM", "sharpness", "flicker", "misplaced");
  for (const Origin origin : kOrigins) text += row(name(origin), evaluation.total[origin]);
  text += fmt::format("{} frames, {} pixels scored\n", evaluation.frames.size(), evaluation.total[Origin::all].pixels);
  if (!evaluation.unscored.empty())
    text += fmt::format("left out, no pixel to score: {}\n", fmt::join(evaluation.unscored, " "));
  return text;
}

}  // namespace dvi
