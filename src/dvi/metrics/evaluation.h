#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/metrics/artifacts.h"
#include "dvi/metrics/ghosts.h"
#include "dvi/metrics/look.h"
#include "dvi/metrics/point_scores.h"

namespace dvi::metrics {

/// The origin of pixels of the result: kinds 1 and 2 are copied, 3 is interpolated, 4 synthesized, 5 empty, 6 imported.
enum class Origin { all, copied, interpolated, synthesized, empty, imported };
inline constexpr std::array kOrigins = {Origin::all,         Origin::copied, Origin::interpolated,
                                        Origin::synthesized, Origin::empty,  Origin::imported};
const char* name(Origin origin);

/// The metrics of docs/metrics.md over a set of scored pixels. NaN means undefined.
struct Figures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::size_t frames = 0;  ///< frames with such pixels
  std::size_t pixels = 0;
  double share = 0;                  ///< share of the scored pixels
  double mae = kNone, rmse = kNone;  ///< gray levels
  double psnr = kNone;               ///< dB
  double ssim = kNone;               ///< at most 1
  double sharpness = kNone;          ///< 1: as sharp as the truth
  double flicker = kNone;            ///< 1: as temporally stable as the truth
  double position_error_px = kNone;  ///< of the copied pixels
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

/// How well a confidence map (8-bit, 255 = 1) predicts the error. NaN means undefined.
struct Calibration {
  static constexpr int kMaxDifference = 10;  ///< gray levels; a pixel within it counts as right

  /// About a tenth of the pixels; the pixels with the same confidence are never split.
  struct Decile {
    double confidence, within, mae;
    std::size_t pixels;
  };

  std::size_t pixels = 0;
  double mean = 0;    ///< mean confidence
  double within = 0;  ///< share of the pixels whose three channels differ by at most kMaxDifference
  double ece = 0;     ///< expected calibration error (Guo et al., 2017), 10 bins of equal width
  double ause = 0;    ///< area under the sparsification error (Ilg et al., 2018); 0 is best. NaN if there are no errors
  std::vector<Decile> deciles;  ///< by increasing confidence, without empty ones
};

struct FrameEvaluation {
  std::string name;
  ByOrigin figures;  ///< flicker is relative to the frame before
};

struct ExternalEvaluation;

struct Evaluation {
  bool has_truth = true;  ///< false: only the figures without a truth are known
  ByOrigin total;
  std::array<std::optional<Intervals>, kOrigins.size()> intervals;  ///< nothing if fewer than two frames have such pixels
  Figures whole_frame;  ///< of whole scored frames, whose other pixels count as exact; MAE to SSIM only
  std::array<std::optional<Calibration>, kOrigins.size()> confidence;  ///< nothing without such pixels or without confidence
  std::vector<FrameEvaluation> frames;                                 ///< the scored frames, in order
  std::vector<std::string> unscored;                                   ///< frames without scored pixels
  std::vector<std::string> warnings;
  Artifacts artifacts;
  std::optional<Look> look;  ///< nothing without unobserved pixels that are filled
  std::optional<Ghosts> ghosts;
  std::string ghosts_left_out;        ///< the reason why ghosts are unknown; empty if it was not asked for them
  std::optional<PointScores> points;  ///< nothing without a truth of the labels of points
  std::vector<ExternalEvaluation> external;
};

/// The evaluation of another program's frames.
struct ExternalEvaluation {
  std::string name;
  Evaluation evaluation;
};

/// Formats the evaluation as a table for the terminal: one row per origin, the unscored frames, and the same for each other
/// program.
std::string format_table(const Evaluation& evaluation);

/// Convert to JSON; undefined values are null.
void to_json(nlohmann::json& json, const Artifacts& artifacts);
void to_json(nlohmann::json& json, const Ghosts& ghosts);
void to_json(nlohmann::json& json, const Look& look);
void to_json(nlohmann::json& json, const Evaluation& evaluation);

}  // namespace dvi::metrics
