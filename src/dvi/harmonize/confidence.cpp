#include "dvi/harmonize/confidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dvi::harmonize {
namespace {

/// Parameters of estimate_error_levels(). They were fitted by maximum likelihood on synthetic streets, with and without errors
/// of the poses (docs/algorithms/confidence.md).
struct CopyErrorParams {
  double noise = 2.5;           ///< Noise of the camera in gray levels.
  double position_error = 1.3;  ///< Factor of position error times texture.
  double spread = 2.8;          ///< Factor of the spread.
  double single_spread = 1;     ///< Spread of a copy without further sources, in gray levels.
  double change = 2;            ///< Factor of the change.
  double per_second = 1;        ///< Error in gray levels per second between target and source.
  double other_drive = 13;  ///< Error in gray levels that replaces change and time, because illumination is expected to differ.
};
constexpr CopyErrorParams kCopyError;

/// Parameters of the logistic function of confidence_of_copy(), fitted together with CopyErrorParams.
struct CopyConfidenceParams {
  double even_levels = 28.6;  ///< Expected error at which the confidence is one half.
  double steepness = 2.27;    ///< Exponent of the error.
};
constexpr CopyConfidenceParams kCopyConfidence;

/// Parameters of ErrorScale. Steps are of the natural logarithm of the expected error, from 1 to 1100 gray levels.
struct ErrorScaleParams {
  double bin_step = 0.1;          ///< Width of the bins in which known copies are counted.
  int bins = 70;                  ///< Number of bins.
  double scale_step = 0.5;        ///< Distance of the errors at which the factor is computed.
  int scale_steps = 15;           ///< Number of these errors.
  double width = 0.6;             ///< Standard deviation of the Gaussian weights.
  double max_logarithm = 1.3863;  ///< Bound of the logarithm of the factor: 1/4 to 4.
  double prior_copies = 200;      ///< Weight of the factor 1.
  /// Known copies have larger errors, because illumination changes faster around a hole than its local mean.
  double known_error_ratio = 1.22;
  int halvings = 12;  ///< Bisections of the interval that contains the factor.
};
constexpr ErrorScaleParams kErrorScale;

/// Known copies with similar expected errors.
struct ErrorBin {
  double copies = 0, within = 0;
};

/// Computes the logarithm of the factor for expected errors near exp(center).
double fit_log_scale(const std::vector<ErrorBin>& bins, double center) {
  double copies = 0, within = 0;
  std::vector<double> weights;
  for (int i = 0; i < kErrorScale.bins; ++i) {
    const double off =
        ((i + 0.5) * kErrorScale.bin_step + std::log(kErrorScale.known_error_ratio) - center) / kErrorScale.width;
    weights.push_back(std::exp(-0.5 * off * off));
    copies += weights.back() * bins[i].copies;
    within += weights.back() * bins[i].within;
  }
  double low = -kErrorScale.max_logarithm, high = kErrorScale.max_logarithm;
  for (int round = 0; round < kErrorScale.halvings; ++round) {
    const double middle = (low + high) / 2;
    double expected = 0;
    for (int i = 0; i < kErrorScale.bins; ++i) {
      const double error = kErrorScale.known_error_ratio * std::exp(middle + (i + 0.5) * kErrorScale.bin_step);
      expected += weights[i] * bins[i].copies * confidence_of_copy(error);
    }
    (expected > within ? low : high) = middle;
  }
  return (low + high) / 2 * copies / (copies + kErrorScale.prior_copies);
}

}  // namespace

double estimate_error_levels(const CopyEvidence& evidence) {
  const double illumination = evidence.is_other_drive
                                  ? kCopyError.other_drive
                                  : std::hypot(kCopyError.change * evidence.change, kCopyError.per_second * evidence.seconds);
  const double parts[] = {kCopyError.noise, kCopyError.position_error * evidence.position_error_px * evidence.texture,
                          kCopyError.spread * (evidence.is_single ? kCopyError.single_spread : evidence.spread), illumination};
  double square = 0;
  for (const double part : parts) square += part * part;
  return std::sqrt(square);
}

double confidence_of_copy(double error_levels) {
  return 1 / (1 + std::pow(error_levels / kCopyConfidence.even_levels, kCopyConfidence.steepness));
}

ErrorScale::ErrorScale(const std::vector<KnownCopy>& copies) {
  std::vector<ErrorBin> bins(kErrorScale.bins);
  for (const KnownCopy& copy : copies) {
    const double place = std::log(copy.expected_levels) / kErrorScale.bin_step;
    ErrorBin& bin = bins[static_cast<std::size_t>(std::clamp(place, 0.0, kErrorScale.bins - 1.0))];
    ++bin.copies;
    bin.within += copy.is_within ? 1 : 0;
  }
  for (int i = 0; i < kErrorScale.scale_steps; ++i) logarithms_.push_back(fit_log_scale(bins, i * kErrorScale.scale_step));
}

double ErrorScale::at(double expected_levels) const {
  const double place =
      std::clamp(std::log(std::max(expected_levels, 1.0)) / kErrorScale.scale_step, 0.0, kErrorScale.scale_steps - 1.0);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min<std::size_t>(below + 1, kErrorScale.scale_steps - 1);
  const double share = place - static_cast<double>(below);
  return std::exp((1 - share) * logarithms_[below] + share * logarithms_[above]);
}

double confidence_of_interpolation(double distance_px) { return 0.02 + 0.4 * std::exp(-distance_px / 8); }

}  // namespace dvi::harmonize
