#include "dvi/diagnostics/check_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "dvi/diagnostics/camera_fit.h"
#include "dvi/geometry/angles.h"

namespace dvi::diagnostics {
namespace {

constexpr double kMinRotationRad = to_radians(kCameraCheck.min_rotation_deg);
constexpr double kRotationStepRad = to_radians(kCameraCheck.rotation_step_deg);

constexpr FreeParts kRotation{true, true, true, false}, kClock{false, false, false, true}, kBoth{true, true, true, true};

struct FoundError {
  CameraError error = CameraError::Zero();
  double cost = 1;
  FreeParts free{};
};

/// Selects the initial guesses of Gauss-Newton: the given camera, the best rotation of a grid, and the best delay of a grid.
std::vector<CameraError> select_starts(const CameraFit& fit) {
  const CameraError zero = CameraError::Zero();
  std::vector<CameraError> out{zero};
  const auto add_best = [&](const std::vector<CameraError>& grid) {
    CameraError best = zero;
    double lowest = fit.cost(zero);
    for (const CameraError& e : grid)
      if (const double cost = fit.cost(e); cost < lowest) lowest = cost, best = e;
    if (!best.isZero()) out.push_back(best);
  };
  std::vector<CameraError> rotations, times;
  const int steps = static_cast<int>(std::lround(to_radians(kCameraCheck.max_rotation_deg) / kRotationStepRad));
  for (int pitch = -steps; pitch <= steps; ++pitch)
    for (int yaw = -steps; yaw <= steps; ++yaw) rotations.emplace_back(kRotationStepRad * pitch, kRotationStepRad * yaw, 0, 0);
  const int delays = static_cast<int>(std::lround(kCameraCheck.max_delay_s / kCameraCheck.delay_step_s));
  for (int k = -delays; k <= delays; ++k) times.emplace_back(0, 0, 0, kCameraCheck.delay_step_s * k);
  add_best(rotations);
  add_best(times);
  return out;
}

FoundError fit_error(const CameraFit& fit, const std::vector<CameraError>& from, const FreeParts& free) {
  FoundError out{CameraError::Zero(), fit.cost(CameraError::Zero()), free};
  for (const CameraError& start : from) {
    CameraError begin = start;
    for (int k = 0; k < 4; ++k)
      if (!free[k]) begin[k] = 0;
    const CameraError error = fit.refine(begin, free);
    if (const double cost = fit.cost(error); cost < out.cost) out.error = error, out.cost = cost;
  }
  return out;
}

/// Finds the simplest error that explains the flow nearly as well as rotation and clock together.
FoundError find_simplest_error(const CameraFit& fit) {
  const std::vector<CameraError> from = select_starts(fit);
  const double given = fit.cost(CameraError::Zero());
  const FoundError both = fit_error(fit, from, kBoth);
  for (const FreeParts& free : {kRotation, kClock})
    if (const FoundError one = fit_error(fit, from, free);
        given - one.cost >= kCameraCheck.min_single_gain * (given - both.cost))
      return one;
  return both;
}

/// Estimates the standard errors of the parts by leaving out one pair at a time (jackknife).
CameraError estimate_standard_errors(const CameraFit& fit, const FoundError& found, std::size_t pairs) {
  std::vector<CameraError> without;
  CameraError mean = CameraError::Zero(), squares = CameraError::Zero();
  for (std::size_t i = 0; i < pairs; ++i) {
    without.push_back(fit.refine(found.error, found.free, i));
    mean += without.back() / static_cast<double>(pairs);
  }
  for (const CameraError& error : without) squares += (error - mean).cwiseAbs2();
  return (squares * (1 - 1 / static_cast<double>(pairs))).cwiseSqrt();
}

/// Returns whether most pairs fit better.
bool is_better_for_most(const std::vector<double>& given, const std::vector<double>& other) {
  std::size_t known = 0, better = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (std::isnan(given[i]) || std::isnan(other[i])) continue;
    ++known;
    better += other[i] < given[i] ? 1 : 0;
  }
  return known >= kCameraCheck.min_pairs &&
         static_cast<double>(better) >= kCameraCheck.min_agreement * static_cast<double>(known);
}

std::string describe_rotation(const Eigen::Vector3d& rotation) {
  constexpr const char* kAbout[] = {"its horizontal axis (pitch)", "the vertical (yaw)", "its optical axis (roll)"};
  std::string parts;
  for (int k = 0; k < 3; ++k)
    if (std::abs(rotation[k]) >= 0.5 * kMinRotationRad)
      parts += fmt::format("{}{:+.1f} degrees about {}", parts.empty() ? "" : ", ", to_degrees(rotation[k]), kAbout[k]);
  return fmt::format(
      "the images indicate that the camera is rotated relative to the LiDAR by {}: check camera_from_lidar, whose rotation "
      "would have to be multiplied from the left by the rotation vector ({:.3f}, {:.3f}, {:.3f}), and the camera's K; clocks "
      "that differ by more than {:g} s have the same effect: compare the times of images and scans first",
      parts, rotation.x(), rotation.y(), rotation.z(), kCameraCheck.max_delay_s);
}

std::string describe_delay(double late_s) {
  return fmt::format(
      "the times of the images seem to be {} by about {:.2f} s relative to the LiDAR: check that both use the same clock; "
      "adding {:.2f} to offset_s of the camera in dvi.toml would correct it (on a straight road, a camera that is mounted {} "
      "by the distance driven in this time has the same effect)",
      late_s > 0 ? "late" : "early", std::abs(late_s), -late_s, late_s > 0 ? "farther behind" : "farther ahead");
}

std::vector<std::string> describe(const CameraFit& fit, const FoundError& found, std::size_t pairs) {
  const std::vector<double> given = fit.costs(CameraError::Zero());
  if (found.cost > kCameraCheck.max_cost || !is_better_for_most(given, fit.costs(found.error))) return {};
  const CameraError& e = found.error;
  const bool is_rotated = e.head<3>().norm() >= kMinRotationRad, is_late = std::abs(e[3]) >= kCameraCheck.min_delay_s;
  if (!is_rotated && !is_late) return {};
  const CameraError sigma = estimate_standard_errors(fit, found, pairs);
  std::vector<std::string> out;
  if (is_rotated && e.head<3>().norm() >= kCameraCheck.min_sigmas * sigma.head<3>().norm())
    out.push_back(describe_rotation(e.head<3>()));
  if (is_late && std::abs(e[3]) >= kCameraCheck.min_sigmas * sigma[3]) out.push_back(describe_delay(e[3]));
  return out;
}

Camera scale_intrinsics(Camera camera, double factor) {
  camera.fx *= factor, camera.fy *= factor, camera.cx *= factor, camera.cy *= factor;
  return camera;
}

/// Returns the factor for K that fits the flow best if its principal point is near the diagonal of the image but far from the
/// center, as in a K for another resolution; nothing otherwise.
std::optional<double> find_resolution_factor(const FlowPairs& pairs, const SE3& camera_from_lidar) {
  constexpr double kMaxRatio = kCameraCheck.max_center_ratio;
  const Camera& camera = pairs.camera;
  const double x = 0.5 * (camera.width - 1) / camera.cx, y = 0.5 * (camera.height - 1) / camera.cy;
  const double mean_ratio = std::sqrt(x * y);
  if (!(std::max(x, y) < kMaxRatio * mean_ratio) || std::max(mean_ratio, 1 / mean_ratio) < kMaxRatio) return std::nullopt;
  double best = mean_ratio, lowest = std::numeric_limits<double>::max();
  for (double factor = mean_ratio / kMaxRatio; factor < mean_ratio * kMaxRatio; factor *= kCameraCheck.scale_step)
    if (const double cost = CameraFit(pairs, scale_intrinsics(camera, factor), camera_from_lidar).cost(CameraError::Zero());
        cost < lowest)
      lowest = cost, best = factor;
  return best;
}

}  // namespace

std::vector<std::string> check_camera(const FlowPairs& pairs, const SE3& camera_from_lidar) {
  const std::size_t count = pairs.pairs.size();
  if (count < kCameraCheck.min_pairs) return {};
  const CameraFit given(pairs, pairs.camera, camera_from_lidar);
  const FoundError found = find_simplest_error(given);
  const auto is_clearly_better = [&](const CameraFit& other) {
    const double cost = other.cost(CameraError::Zero());
    return cost <= kCameraCheck.max_cost && cost < kCameraCheck.max_relative_cost * found.cost;
  };
  if (const auto factor = find_resolution_factor(pairs, camera_from_lidar))
    if (is_clearly_better(CameraFit(pairs, scale_intrinsics(pairs.camera, *factor), camera_from_lidar)))
      return {fmt::format("K seems to be for images {:.2f} times as wide: multiply its fx, fy, cx, and cy by {:.2f}",
                          1 / *factor, *factor)};
  if (is_clearly_better(CameraFit(pairs, pairs.camera, camera_from_lidar.inverse())))
    return {"camera_from_lidar seems to be inverted: write the matrix that transforms points from LiDAR axes to camera axes"};
  if (Camera fisheye = pairs.camera; !fisheye.is_wide()) {
    fisheye.set_lens({.model = CameraModel::fisheye});
    if (is_clearly_better(CameraFit(pairs, fisheye, camera_from_lidar)))
      return {
          "the images seem to be of a fisheye lens, not of a pinhole camera: set model = \"fisheye\" and its distortion in "
          "dvi.toml"};
  }
  if (given.compute_visible_share() < kCameraCheck.min_visible_share)
    return {"almost no returns of the LiDAR are within the image of the camera: check camera_from_lidar and K"};
  return describe(given, found, count);
}

}  // namespace dvi::diagnostics
