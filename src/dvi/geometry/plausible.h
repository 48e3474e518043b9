#pragma once

#include <array>
#include <string>

#include "dvi/core/files.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// The largest deviation of a rotation that was written as text with few digits.
inline constexpr double kMaxRotationError = 1e-3;

/// Describes why a matrix is not a rotation, with its values and the requirement; returns an empty text if it is one. Rows and
/// columns must have length 1 and be orthogonal, and the determinant must be +1, each within kMaxRotationError.
std::string describe_rotation_problem(const Eigen::Matrix3d& R);

/// Describes why a matrix (row-major: fx 0 cx, 0 fy cy, 0 0 1) is not a camera matrix for any image; returns an empty text if
/// it is one.
std::string describe_camera_matrix_problem(const std::array<double, 9>& K);

/// Throws InputError about `field` of `file` if a camera is implausible. The image must have pixels, but not too many; fx and
/// fy must be 0.05 to 50 times its width; the principal point must be within the image enlarged by half its size on each side.
void require_plausible(const Camera& camera, const fs::path& file, const std::string& field);

/// Describes why a camera is not for its images: its principal point is far from their center, as for K of images with a
/// different size. Returns an empty text otherwise.
std::string describe_off_center_problem(const Camera& camera);

/// Throws InputError if a position is 1e8 m or farther from the origin, beyond any map projection. Voxels are counted in
/// integers.
void require_near(const Eigen::Vector3d& position, const fs::path& file, const std::string& what);

/// Throws InputError if a name could refer to another folder: if it is empty, contains '/' or '\', or is '.' or '..'.
void require_plain_name(const std::string& name, const fs::path& file, const std::string& what);

}  // namespace dvi
