#pragma once

#include <array>
#include <string>

#include "dvi/core/files.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// What few digits may cost a rotation that was written as text.
inline constexpr double kPrintedRotation = 1e-3;

/// What is wrong with a matrix that should be a rotation, with its value and what is right; empty where nothing is. Rows and
/// columns of length 1, at right angles, determinant +1, each within kPrintedRotation.
std::string rotation_problem(const Eigen::Matrix3d& R);

/// What is wrong with a camera matrix (row-major: fx 0 cx, 0 fy cy, 0 0 1) whatever the image; empty where nothing is.
std::string camera_matrix_problem(const std::array<double, 9>& K);

/// InputError where a camera cannot be: `file` and `field` name where it is from. The image has pixels, and no more than are
/// read; fx and fy are 0.05 to 50 times its width; the principal point is within the image enlarged by half its size each way.
void require_plausible(const Camera& camera, const fs::path& file, const std::string& field);

/// What is wrong where a camera's principal point is far from the middle of its images, as it is if K is that of images of
/// another size; empty where it is not.
std::string off_center_problem(const Camera& camera);

/// InputError where a position is 1e8 m or farther from the origin, beyond any map projection. Voxels are counted in integers.
void require_near(const Eigen::Vector3d& position, const fs::path& file, const std::string& what);

/// InputError where a name could lead out of its folder: it is not empty, has no '/' or '\', and is not '.' or '..'.
void require_plain_name(const std::string& name, const fs::path& file, const std::string& what);

}  // namespace dvi
