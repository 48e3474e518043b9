#include "dvi/harmonize/confidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dvi::harmonize {
namespace {

// Of the logarithm of the expected error, from 1 to 1100 gray levels.
constexpr double kErrorBin = 0.1, kErrorStep = 0.5;
constexpr int kErrorBins = 70, kErrorSteps = 15;

/// Known copies that are expected to be off alike.
struct ErrorBin {
  double copies = 0, within = 0;
};

/// The scale's logarithm for expected errors round one whose logarithm is `center`.
double scale_near(const std::vector<ErrorBin>& bins, double center) {
  constexpr double kWidth = 0.6;
  constexpr double kLargest = 1.3863;  // 1/4 .. 4
  constexpr double kPrior = 200;       // copies that count as much as "as expected"
  constexpr double kSurplus = 1.22;    // light changes faster round a hole than a mean tells: known copies are off by more
  constexpr int kHalvings = 12;
  double copies = 0, within = 0;
  std::vector<double> weights;
  for (int i = 0; i < kErrorBins; ++i) {
    const double off = ((i + 0.5) * kErrorBin + std::log(kSurplus) - center) / kWidth;
    weights.push_back(std::exp(-0.5 * off * off));
    copies += weights.back() * bins[i].copies;
    within += weights.back() * bins[i].within;
  }
  double low = -kLargest, high = kLargest;
  for (int round = 0; round < kHalvings; ++round) {
    const double middle = (low + high) / 2;
    double said = 0;
    for (int i = 0; i < kErrorBins; ++i)
      said += weights[i] * bins[i].copies * copied_confidence(kSurplus * std::exp(middle + (i + 0.5) * kErrorBin));
    (said > within ? low : high) = middle;
  }
  return (low + high) / 2 * copies / (copies + kPrior);
}

}  // namespace

double expected_error(const CopyEvidence& evidence) {
  // Fitted by maximum likelihood on synthetic streets, with and without errors in their poses (docs/algorithms/confidence.md).
  constexpr double kNoise = 2.5, kShift = 1.3, kSpread = 2.8, kAlone = 1, kChange = 2, kPerSecond = 1, kElsewhere = 13;
  // What the solution changes is another light, seldom an error, where that was to be expected.
  const double light = evidence.elsewhere ? kElsewhere : std::hypot(kChange * evidence.change, kPerSecond * evidence.seconds);
  const double parts[] = {kNoise, kShift * evidence.shift * evidence.texture,
                          kSpread * (evidence.alone ? kAlone : evidence.spread), light};
  double square = 0;
  for (const double part : parts) square += part * part;
  return std::sqrt(square);
}

double copied_confidence(double error) {
  constexpr double kEven = 28.6, kSteep = 2.27;  // the expected error at which it is even, and how fast it falls there
  return 1 / (1 + std::pow(error / kEven, kSteep));
}

ErrorScale::ErrorScale(const std::vector<KnownCopy>& copies) {
  std::vector<ErrorBin> bins(kErrorBins);
  for (const KnownCopy& copy : copies) {
    ErrorBin& bin = bins[static_cast<std::size_t>(std::clamp(std::log(copy.expected) / kErrorBin, 0.0, kErrorBins - 1.0))];
    ++bin.copies;
    bin.within += copy.within ? 1 : 0;
  }
  for (int i = 0; i < kErrorSteps; ++i) logarithms_.push_back(scale_near(bins, i * kErrorStep));
}

double ErrorScale::at(double expected) const {
  const double place = std::clamp(std::log(std::max(expected, 1.0)) / kErrorStep, 0.0, kErrorSteps - 1.0);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min<std::size_t>(below + 1, kErrorSteps - 1);
  const double share = place - static_cast<double>(below);
  return std::exp((1 - share) * logarithms_[below] + share * logarithms_[above]);
}

double interpolated_confidence(double distance) { return 0.02 + 0.4 * std::exp(-distance / 8); }

}  // namespace dvi::harmonize
