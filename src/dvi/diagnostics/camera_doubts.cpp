#include "dvi/diagnostics/camera_doubts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "dvi/diagnostics/camera_fit.h"

namespace dvi::diagnostics {
namespace {

constexpr std::size_t kFewestPairs = 5;
constexpr double kExplained = 0.6;  // a cost above: most returns do not move as predicted, the reading explains nothing
constexpr double kBetter = 0.75;    // of the cost as given: below, another reading is clearly better
constexpr double kSure = 3;         // standard errors by which an error is not zero
constexpr double kAgreed = 0.75;    // of the pairs must fit better: one with a truck in it must not decide
// What alignment does not make up for: several times its expected error of the mounting, and the search range of clocks.
constexpr double kLeastRotation = std::numbers::pi / 180, kLeastLate = 0.04;
constexpr double kMostRotation = 8 * std::numbers::pi / 180, kRotationStep = 2 * std::numbers::pi / 180;
constexpr double kMostLate = 1.2, kLateStep = 0.1;
constexpr double kAlone = 0.9;         // of the gain of rotation and clock together: then one alone is wrong
constexpr double kFewReturns = 0.002;  // of a scan's returns, in the image

constexpr FreeParts kRotation{true, true, true, false}, kClock{false, false, false, true}, kBoth{true, true, true, true};

struct Found {
  CameraError error = CameraError::Zero();
  double cost = 1;
  FreeParts free{};
};

/// Where Gauss-Newton begins: as given, and the best of a grid of rotations and one of times.
std::vector<CameraError> starts(const CameraFit& fit) {
  const CameraError zero = CameraError::Zero();
  std::vector<CameraError> out{zero};
  const auto best_of = [&](const std::vector<CameraError>& grid) {
    CameraError best = zero;
    double least = fit.cost(zero);
    for (const CameraError& e : grid)
      if (const double cost = fit.cost(e); cost < least) least = cost, best = e;
    if (!best.isZero()) out.push_back(best);
  };
  std::vector<CameraError> rotations, times;
  const int most = static_cast<int>(std::lround(kMostRotation / kRotationStep));
  for (int pitch = -most; pitch <= most; ++pitch)
    for (int yaw = -most; yaw <= most; ++yaw) rotations.emplace_back(kRotationStep * pitch, kRotationStep * yaw, 0, 0);
  const int late = static_cast<int>(std::lround(kMostLate / kLateStep));
  for (int k = -late; k <= late; ++k) times.emplace_back(0, 0, 0, kLateStep * k);
  best_of(rotations);
  best_of(times);
  return out;
}

Found best_error(const CameraFit& fit, const std::vector<CameraError>& from, const FreeParts& free) {
  Found out{CameraError::Zero(), fit.cost(CameraError::Zero()), free};
  for (const CameraError& start : from) {
    CameraError begin = start;
    for (int k = 0; k < 4; ++k)
      if (!free[k]) begin[k] = 0;
    const CameraError error = fit.refined(begin, free);
    if (const double cost = fit.cost(error); cost < out.cost) out.error = error, out.cost = cost;
  }
  return out;
}

/// The simplest error that explains the flow nearly as well as rotation and clock together.
Found simplest_error(const CameraFit& fit) {
  const std::vector<CameraError> from = starts(fit);
  const double given = fit.cost(CameraError::Zero());
  const Found both = best_error(fit, from, kBoth);
  for (const FreeParts& free : {kRotation, kClock})
    if (const Found one = best_error(fit, from, free); given - one.cost >= kAlone * (given - both.cost)) return one;
  return both;
}

/// Standard errors of the parts, by leaving out one pair after the other (jackknife).
CameraError standard_errors(const CameraFit& fit, const Found& found, std::size_t pairs) {
  std::vector<CameraError> without;
  CameraError mean = CameraError::Zero(), squares = CameraError::Zero();
  for (std::size_t i = 0; i < pairs; ++i) {
    without.push_back(fit.refined(found.error, found.free, i));
    mean += without.back() / static_cast<double>(pairs);
  }
  for (const CameraError& error : without) squares += (error - mean).cwiseAbs2();
  return (squares * (1 - 1 / static_cast<double>(pairs))).cwiseSqrt();
}

/// Whether the pairs agree that they fit better.
bool surely_better(const std::vector<double>& given, const std::vector<double>& other) {
  std::size_t known = 0, better = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (std::isnan(given[i]) || std::isnan(other[i])) continue;
    ++known;
    better += other[i] < given[i] ? 1 : 0;
  }
  return known >= kFewestPairs && static_cast<double>(better) >= kAgreed * static_cast<double>(known);
}

std::string rotation_words(const Eigen::Vector3d& rotation) {
  constexpr const char* kAbout[] = {"its horizontal axis (pitch)", "the vertical (yaw)", "its optical axis (roll)"};
  std::string parts;
  for (int k = 0; k < 3; ++k)
    if (std::abs(rotation[k]) >= 0.5 * kLeastRotation)
      parts +=
          fmt::format("{}{:+.1f} degrees about {}", parts.empty() ? "" : ", ", rotation[k] * 180 / std::numbers::pi, kAbout[k]);
  return fmt::format(
      "the images move as if the camera were rotated against the LiDAR by {}: check camera_from_lidar, whose rotation would "
      "have to be multiplied from the left by the rotation vector ({:.3f}, {:.3f}, {:.3f}), and the camera's K; clocks that "
      "differ by more than {:g} s look alike: compare the times of images and scans first",
      parts, rotation.x(), rotation.y(), rotation.z(), kMostLate);
}

std::string clock_words(double late_s) {
  return fmt::format(
      "the images' times look {} by about {:.2f} s against the LiDAR's: check that both share one clock; adding {:.2f} to "
      "offset_s of the camera in dvi.toml would make up for it (on a straight road, a camera mounted that much of the way {} "
      "looks alike)",
      late_s > 0 ? "late" : "early", std::abs(late_s), -late_s, late_s > 0 ? "farther behind" : "farther ahead");
}

std::vector<std::string> words_of(const CameraFit& fit, const Found& found, std::size_t pairs) {
  const std::vector<double> given = fit.costs(CameraError::Zero());
  if (found.cost > kExplained || !surely_better(given, fit.costs(found.error))) return {};
  const CameraError& e = found.error;
  const bool turned = e.head<3>().norm() >= kLeastRotation, late = std::abs(e[3]) >= kLeastLate;
  if (!turned && !late) return {};
  const CameraError sigma = standard_errors(fit, found, pairs);
  std::vector<std::string> out;
  if (turned && e.head<3>().norm() >= kSure * sigma.head<3>().norm()) out.push_back(rotation_words(e.head<3>()));
  if (late && std::abs(e[3]) >= kSure * sigma[3]) out.push_back(clock_words(e[3]));
  return out;
}

Camera scaled(Camera camera, double factor) {
  camera.fx *= factor, camera.fy *= factor, camera.cx *= factor, camera.cy *= factor;
  return camera;
}

/// By how much K is to be multiplied to fit the flow best, where its principal point lies near the image's diagonal but far
/// from its middle, as in a K of another resolution.
std::optional<double> other_resolution(const FlowPairs& pairs, const SE3& camera_from_lidar) {
  constexpr double kNear = 1.15, kStep = 1.02;  // a principal point's distance from the middle; of what is tried
  const Camera& camera = pairs.camera;
  const double x = 0.5 * (camera.width - 1) / camera.cx, y = 0.5 * (camera.height - 1) / camera.cy;
  const double middle = std::sqrt(x * y);
  if (!(std::max(x, y) < kNear * middle) || std::max(middle, 1 / middle) < kNear) return std::nullopt;
  double best = middle, least = std::numeric_limits<double>::max();
  for (double factor = middle / kNear; factor < middle * kNear; factor *= kStep)
    if (const double cost = CameraFit(pairs, scaled(camera, factor), camera_from_lidar).cost(CameraError::Zero()); cost < least)
      least = cost, best = factor;
  return best;
}

}  // namespace

std::vector<std::string> camera_doubts(const FlowPairs& pairs, const SE3& camera_from_lidar) {
  const std::size_t count = pairs.pairs.size();
  if (count < kFewestPairs) return {};
  const CameraFit given(pairs, pairs.camera, camera_from_lidar);
  const Found found = simplest_error(given);
  const auto clearly_better = [&](const CameraFit& other) {
    const double cost = other.cost(CameraError::Zero());
    return cost <= kExplained && cost < kBetter * found.cost;
  };
  if (const auto factor = other_resolution(pairs, camera_from_lidar))
    if (clearly_better(CameraFit(pairs, scaled(pairs.camera, *factor), camera_from_lidar)))
      return {fmt::format("K looks like that of images {:.2f} times as wide: multiply its fx, fy, cx and cy by {:.2f}",
                          1 / *factor, *factor)};
  if (clearly_better(CameraFit(pairs, pairs.camera, camera_from_lidar.inverse())))
    return {"camera_from_lidar looks inverted: write the matrix that brings points of the LiDAR into the camera's axes"};
  if (given.share_in_sight() < kFewReturns)
    return {"hardly a return of the LiDAR lies in the camera's image: check camera_from_lidar and K"};
  return words_of(given, found, count);
}

}  // namespace dvi::diagnostics
