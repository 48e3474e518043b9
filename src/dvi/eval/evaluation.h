#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace dvi {

/// By where the pixels of the result come from: kinds 1 and 2 are copied, 3 interpolated, 4 synthesised, 5 left empty.
enum class Origin { all, copied, interpolated, synthesised, empty };
inline constexpr std::array kOrigins = {Origin::all, Origin::copied, Origin::interpolated, Origin::synthesised, Origin::empty};
const char* name(Origin origin);

/// The metrics of docs/metrics.md over some scored pixels. NaN: undefined there.
struct Figures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::size_t frames = 0;  ///< that have such pixels
  std::size_t pixels = 0;
  double share = 0;                  ///< of the scored pixels
  double mae = kNone, rmse = kNone;  ///< grey levels
  double psnr = kNone;               ///< dB
  double ssim = kNone;               ///< at most 1
  double sharpness = kNone;          ///< 1: as sharp as the truth
  double flicker = kNone;            ///< 1: as steady as the truth
  double misplaced_px = kNone;       ///< of the copied pixels
};

struct ByOrigin {
  std::array<Figures, kOrigins.size()> figures;
  Figures& operator[](Origin origin) { return figures[static_cast<std::size_t>(origin)]; }
  const Figures& operator[](Origin origin) const { return figures[static_cast<std::size_t>(origin)]; }
};

struct FrameEvaluation {
  std::string name;
  ByOrigin figures;  ///< flicker: against the frame before
};

struct Evaluation {
  ByOrigin total;
  std::vector<FrameEvaluation> frames;  ///< those scored, in order
  std::vector<std::string> unscored;    ///< frames left out: no pixel of theirs is to be scored
  std::vector<std::string> warnings;
};

/// For people: a row an origin, and what was left out.
std::string table(const Evaluation& evaluation);

/// For machines; what is undefined is null.
void to_json(nlohmann::json& json, const Evaluation& evaluation);

}  // namespace dvi
