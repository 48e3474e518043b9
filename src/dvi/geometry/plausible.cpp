#include "dvi/geometry/plausible.h"

#include <cmath>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/options.h"

namespace dvi {
namespace {

constexpr double kMinFocal = 0.05, kMaxFocal = 50;  // in image widths

}  // namespace

std::string describe_rotation_problem(const Eigen::Matrix3d& R) {
  if (!R.allFinite()) return "does not hold a rotation: its numbers are not finite";
  const double determinant = R.determinant();
  const double skewed = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (skewed <= 2 * kMaxRotationError && determinant < 0)
    return fmt::format("does not hold a rotation: its determinant is {:.4g} instead of 1, so it mirrors", determinant);
  if (skewed > 2 * kMaxRotationError || std::abs(determinant - 1) > 3 * kMaxRotationError)
    return fmt::format(
        "does not hold a rotation: its rows have lengths {:.4g}, {:.4g}, {:.4g} and its determinant is {:.4g}, which "
        "must all be 1",
        R.row(0).norm(), R.row(1).norm(), R.row(2).norm(), determinant);
  return {};
}

std::string describe_camera_matrix_problem(const std::array<double, 9>& K) {
  constexpr double kMaxZero = 1e-6;  // relative to the focal length
  constexpr const char* kLayout = "write fx, 0, cx, 0, fy, cy, 0, 0, 1, row by row in pixels";
  const double none = kMaxZero * std::abs(K[0]);
  if (K[2] == 0 && K[5] == 0 && (K[6] != 0 || K[7] != 0))
    return fmt::format("is transposed: its last row is {:g} {:g} {:g} instead of 0 0 1; {}", K[6], K[7], K[8], kLayout);
  if (K[6] != 0 || K[7] != 0 || std::abs(K[8] - 1) > kMaxZero)
    return fmt::format("has {:g} {:g} {:g} as its last row instead of 0 0 1; {}", K[6], K[7], K[8], kLayout);
  if (!(K[0] > 0 && K[4] > 0))
    return fmt::format("has fx = {:g} and fy = {:g}, which must be positive; {}", K[0], K[4], kLayout);
  if (std::abs(K[1]) > none || std::abs(K[3]) > none)
    return fmt::format("has {:g} and {:g} beside fx and fy instead of 0: skewed pixels are not supported; {}", K[1], K[3],
                       kLayout);
  return {};
}

void require_plausible(const Camera& camera, const fs::path& file, const std::string& field) {
  const double width = camera.width, height = camera.height;
  if (!(width > 0 && height > 0 && width * height <= static_cast<double>(kMaxPixels)))
    throw InputError(file, fmt::format("{}: the image size is {}x{}", field, camera.width, camera.height),
                     "sides must be positive, with at most 2^28 pixels");
  const auto require_within = [&](const char* name, double value, const Range& range, const char* reason) {
    if (!(value >= range.low && value <= range.high))
      throw InputError(
          file, fmt::format("{}: {} = {:g} px is not within {:g} to {:g}", field, name, value, range.low, range.high), reason);
  };
  constexpr const char* kFocal = "focal lengths in pixels must be 0.05 to 50 times the image's width";
  require_within("fx", camera.fx, {kMinFocal * width, kMaxFocal * width}, kFocal);
  require_within("fy", camera.fy, {kMinFocal * width, kMaxFocal * width}, kFocal);
  constexpr const char* kCenter = "the principal point must be in or near the image";
  require_within("cx", camera.cx, {-0.5 * width, 1.5 * width}, kCenter);
  require_within("cy", camera.cy, {-0.5 * height, 1.5 * height}, kCenter);
}

std::string describe_off_center_problem(const Camera& camera) {
  constexpr double kMaxOffset =
      0.15;  // fraction of the image; cameras stay within a few percent, and other sizes are at most 0.75 of this one
  const double x = (camera.cx + 0.5) / camera.width, y = (camera.cy + 0.5) / camera.height;
  if (std::abs(x - 0.5) < kMaxOffset && std::abs(y - 0.5) < kMaxOffset) return {};
  return fmt::format(
      "is {}x{} pixels, but the principal point of its camera is at {:g}, {:g}: this camera is for images with a different "
      "size",
      camera.width, camera.height, camera.cx, camera.cy);
}

void require_near(const Eigen::Vector3d& position, const fs::path& file, const std::string& what) {
  constexpr double kMaxDistanceM = 1e8;
  const double farthest = position.cwiseAbs().maxCoeff();
  if (!(farthest < kMaxDistanceM))
    throw InputError(file, fmt::format("{} is {:g} m from the origin", what, farthest),
                     fmt::format("positions must be in meters and below {:g}", kMaxDistanceM));
}

void require_plain_name(const std::string& name, const fs::path& file, const std::string& what) {
  const bool plain = !name.empty() && name != "." && name != ".." && name.find_first_of("/\\") == std::string::npos &&
                     name.find('\0') == std::string::npos;
  if (!plain)
    throw InputError(file, fmt::format("'{}' is not a valid name of {}", name, what),
                     "names must not be empty or contain '/' or '..'");
}

}  // namespace dvi
