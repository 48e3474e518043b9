#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/metrics/artifacts.h"

namespace dvi::metrics {

/// By where the pixels of the result come from: kinds 1 and 2 are copied, 3 interpolated, 4 synthesized, 5 left empty.
enum class Origin { all, copied, interpolated, synthesized, empty };
inline constexpr std::array kOrigins = {Origin::all, Origin::copied, Origin::interpolated, Origin::synthesized, Origin::empty};
const char* name(Origin origin);

/// The metrics of docs/metrics.md over some scored pixels. NaN: undefined there.
struct Figures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::size_t frames = 0;  ///< that have such pixels
  std::size_t pixels = 0;
  double share = 0;                  ///< of the scored pixels
  double mae = kNone, rmse = kNone;  ///< gray levels
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

/// The 95 % confidence interval of a figure over frames, low and high.
using Interval = std::array<double, 2>;

struct Intervals {
  Interval mae, rmse, psnr, ssim, sharpness;
};

/// How well a confidence map (8-bit, 255 = 1) foretells the error. NaN: undefined.
struct Calibration {
  static constexpr int kWithin = 10;  ///< gray levels

  /// About a tenth of the pixels: a level of confidence is never split.
  struct Decile {
    double confidence, within, mae;
    std::size_t pixels;
  };

  std::size_t pixels = 0;
  double mean = 0;              ///< of the confidence
  double within = 0;            ///< share of the pixels whose three channels differ by at most kWithin
  double ece = 0;               ///< expected calibration error (Guo et al., 2017), 10 bins of equal width
  double ause = 0;              ///< area under the sparsification error (Ilg et al., 2018); 0 is best. NaN: no error at all
  std::vector<Decile> deciles;  ///< by rising confidence; those that no level falls into are left out
};

struct FrameEvaluation {
  std::string name;
  ByOrigin figures;  ///< flicker: against the frame before
};

struct ExternalEvaluation;

struct Evaluation {
  ByOrigin total;
  std::array<std::optional<Intervals>, kOrigins.size()> intervals;  ///< none where fewer than two frames have such pixels
  Figures whole_frame;  ///< of the scored frames as whole pictures, pixels that are not scored being exact; MAE to SSIM only
  std::array<std::optional<Calibration>, kOrigins.size()> confidence;  ///< none where there is no such pixel or no confidence
  std::vector<FrameEvaluation> frames;                                 ///< those scored, in order
  std::vector<std::string> unscored;                                   ///< frames left out: no pixel of theirs is to be scored
  std::vector<std::string> warnings;
  Artifacts artifacts;
  std::vector<ExternalEvaluation> external;
};

/// Another program's frames.
struct ExternalEvaluation {
  std::string name;
  Evaluation evaluation;
};

/// For people: a row an origin, and what was left out; the same for each other program.
std::string table(const Evaluation& evaluation);

/// For machines; what is undefined is null.
void to_json(nlohmann::json& json, const Artifacts& artifacts);
void from_json(const nlohmann::json& json, Artifacts& artifacts);
void to_json(nlohmann::json& json, const Evaluation& evaluation);

}  // namespace dvi::metrics
