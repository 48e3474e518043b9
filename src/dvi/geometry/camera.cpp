#include "dvi/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/core/text.h"
#include "dvi/geometry/lens.h"

namespace dvi {
namespace {

constexpr double kNearest = 0.05;  // in meters; a nearer point has no projection

/// Returns the smallest z of a direction (a unit vector) that the unified model projects, exclusive (Mei and Rives 2007).
double find_lowest_z(double xi) { return xi <= 1 ? -xi : -1 / xi; }

Eigen::Vector2d project_to_sphere(const Eigen::Vector3d& x, double xi) { return x.head<2>() / (x.z() + xi * x.norm()); }

/// Returns the unit vector whose image behind the sphere is `m`; beyond the last one, that one.
Eigen::Vector3d lift_to_sphere(const Eigen::Vector2d& m, double xi) {
  const double r2 = m.squaredNorm(), root = 1 + (1 - xi * xi) * r2;
  if (root > 0) {
    const double factor = (xi + std::sqrt(root)) / (1 + r2);
    return {factor * m.x(), factor * m.y(), factor - xi};
  }
  const double z = find_lowest_z(xi);
  const Eigen::Vector2d side = std::sqrt(1 - z * z) * m.normalized();
  return {side.x(), side.y(), z};
}

/// Returns the direction at an angle off the axis toward a side of it.
Eigen::Vector3d to_direction(double angle, const Eigen::Vector2d& side) {
  const double length = side.norm();
  if (length == 0) return {0, 0, 1};
  const Eigen::Vector2d flat = std::sin(angle) / length * side;
  return {flat.x(), flat.y(), std::cos(angle)};
}

double measure_angle(const Eigen::Vector3d& x) { return std::atan2(x.head<2>().norm(), x.z()); }

/// Returns x with its columns scaled by the focal lengths.
Eigen::Matrix<double, 2, 3> scale(const Camera& camera, const Eigen::Matrix<double, 2, 3>& x) {
  return Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * x;
}

Eigen::Matrix<double, 2, 3> differentiate_plane(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 2, 3> out;
  out << 1 / x.z(), 0, -x.x() / x.z() / x.z(), 0, 1 / x.z(), -x.y() / x.z() / x.z();
  return out;
}

Eigen::Matrix<double, 2, 3> differentiate_fisheye(const AngleDistortion& lens, const Eigen::Vector3d& x) {
  const double rho = x.head<2>().norm(), squared = x.squaredNorm();
  if (rho < 1e-9 * std::abs(x.z())) return differentiate_plane(x);
  const double angle = measure_angle(x), factor = lens.radius(angle) / rho;
  const Eigen::RowVector3d by_rho(x.x() / rho, x.y() / rho, 0);
  const Eigen::RowVector3d by_angle(x.x() * x.z() / rho / squared, x.y() * x.z() / rho / squared, -rho / squared);
  Eigen::Matrix<double, 2, 3> out = x.head<2>() * ((lens.slope(angle) * by_angle - factor * by_rho) / rho);
  out(0, 0) += factor, out(1, 1) += factor;
  return out;
}

Eigen::Matrix<double, 2, 3> differentiate_sphere(const Eigen::Vector3d& x, double xi) {
  const double length = x.norm(), below = x.z() + xi * length;
  Eigen::RowVector3d by_below = xi / length * x.transpose();
  by_below.z() += 1;
  Eigen::Matrix<double, 2, 3> out = -x.head<2>() / below * (by_below / below);
  out(0, 0) += 1 / below, out(1, 1) += 1 / below;
  return out;
}

Eigen::Matrix<double, 2, 3> differentiate_panorama(const Camera& camera, const Eigen::Vector3d& x) {
  const double rho = std::hypot(x.x(), x.z()), squared = x.squaredNorm(), cube = rho * rho * rho;
  Eigen::Matrix<double, 2, 3> out;
  out.row(0) << x.z() / rho / rho, 0, -x.x() / rho / rho;
  if (camera.model == CameraModel::cylindrical)
    out.row(1) << -x.y() * x.x() / cube, 1 / rho, -x.y() * x.z() / cube;
  else
    out.row(1) << -x.y() * x.x() / rho / squared, rho / squared, -x.y() * x.z() / rho / squared;
  return out;
}

/// In a panorama of the full turn, moves positions between the last and the first column to the nearer one, at most half a
/// pixel: each direction is in the image.
Eigen::Vector2d close_seam(const Camera& camera, Eigen::Vector2d pixel) {
  const double period = camera.period_px();
  if (std::abs(period - camera.width) > 0.5) return pixel;
  pixel.x() -= period * std::floor((pixel.x() + 0.5) / period);
  return {std::clamp(pixel.x(), 0.0, camera.width - 1.0), pixel.y()};
}

}  // namespace

std::string to_string(CameraModel model) {
  switch (model) {
    case CameraModel::pinhole:
      return "pinhole";
    case CameraModel::fisheye:
      return "fisheye";
    case CameraModel::unified:
      return "unified";
    case CameraModel::equirectangular:
      return "equirectangular";
    case CameraModel::cylindrical:
      return "cylindrical";
  }
  throw std::invalid_argument("no camera model");
}

std::optional<CameraModel> find_camera_model(const std::string& name) {
  static const std::map<std::string, CameraModel> models = {
      {"pinhole", CameraModel::pinhole},
      {"perspective", CameraModel::pinhole},
      {"opencv", CameraModel::pinhole},
      {"full_opencv", CameraModel::pinhole},
      {"plumb_bob", CameraModel::pinhole},
      {"rational_polynomial", CameraModel::pinhole},
      {"radtan", CameraModel::pinhole},
      {"brown", CameraModel::pinhole},
      {"none", CameraModel::pinhole},
      {"fisheye", CameraModel::fisheye},
      {"opencv_fisheye", CameraModel::fisheye},
      {"equidistant", CameraModel::fisheye},
      {"equi", CameraModel::fisheye},
      {"kannala_brandt", CameraModel::fisheye},
      {"unified", CameraModel::unified},
      {"mei", CameraModel::unified},
      {"omni", CameraModel::unified},
      {"omnidir", CameraModel::unified},
      {"equirectangular", CameraModel::equirectangular},
      {"spherical", CameraModel::equirectangular},
      {"cylindrical", CameraModel::cylindrical},
  };
  const auto found = models.find(to_lower_case(name));
  return found == models.end() ? std::nullopt : std::optional(found->second);
}

std::string describe_lens_problem(CameraModel model, std::span<const double> coefficients) {
  const std::size_t count = coefficients.size();
  const auto has_rest = [&](std::size_t kept) {
    return std::any_of(coefficients.begin() + static_cast<std::ptrdiff_t>(kept), coefficients.end(),
                       [](double k) { return k != 0; });
  };
  switch (model) {
    case CameraModel::pinhole:
      if (count == 12 || count == 14)
        return has_rest(8) ? "has coefficients of a thin prism or a tilted sensor, which are not supported" : "";
      if (count == 0 || count == 4 || count == 5 || count == 8) return {};
      return fmt::format("has {} numbers instead of 5 (k1, k2, p1, p2, k3) or 8 (k4, k5, k6 as well)", count);
    case CameraModel::fisheye:
      return count == 0 || count == 4 ? "" : fmt::format("has {} numbers instead of 4 (k1, k2, k3, k4)", count);
    case CameraModel::unified:
      return count == 0 || count == 4 ? "" : fmt::format("has {} numbers instead of 4 (k1, k2, p1, p2)", count);
    case CameraModel::equirectangular:
    case CameraModel::cylindrical:
      return has_rest(0) ? "has numbers, but panoramas have no distortion" : "";
  }
  return {};
}

Lens make_lens(CameraModel model, std::span<const double> coefficients, double xi) {
  Lens out{.model = model, .xi = xi};
  std::copy_n(coefficients.begin(), std::min(coefficients.size(), out.distortion.size()), out.distortion.begin());
  return out;
}

std::span<const double> Camera::coefficients() const {
  const std::span<const double> all(distortion);
  if (model == CameraModel::pinhole) {
    const auto others = all.subspan(5);
    return all.first(std::all_of(others.begin(), others.end(), [](double k) { return k == 0; }) ? 5 : 8);
  }
  return all.first(model == CameraModel::fisheye || model == CameraModel::unified ? 4 : 0);
}

double Camera::period_px() const {
  const bool is_panorama = model == CameraModel::equirectangular || model == CameraModel::cylindrical;
  return is_panorama ? 2 * std::numbers::pi * fx : 0;
}

Eigen::Vector2d Camera::project_distorted(const Eigen::Vector3d& x) const {
  const auto to_pixel = [&](const Eigen::Vector2d& n) { return Eigen::Vector2d(fx * n.x() + cx, fy * n.y() + cy); };
  switch (model) {
    case CameraModel::pinhole:
      return to_pixel(PlaneDistortion(distortion).distort(x.head<2>() / x.z()));
    case CameraModel::fisheye: {
      const double rho = x.head<2>().norm();
      if (rho == 0) return {cx, cy};
      return to_pixel(AngleDistortion(distortion).radius(measure_angle(x)) / rho * x.head<2>());
    }
    case CameraModel::unified:
      return to_pixel(PlaneDistortion(distortion).distort(project_to_sphere(x, xi)));
    case CameraModel::equirectangular:
      return close_seam(*this, to_pixel({std::atan2(x.x(), x.z()), std::atan2(x.y(), std::hypot(x.x(), x.z()))}));
    case CameraModel::cylindrical:
      return close_seam(*this, to_pixel({std::atan2(x.x(), x.z()), x.y() / std::hypot(x.x(), x.z())}));
  }
  return {};
}

Eigen::Matrix<double, 2, 3> Camera::differentiate(const Eigen::Vector3d& x) const {
  switch (model) {
    case CameraModel::pinhole:
      if (!is_distorted()) return scale(*this, differentiate_plane(x));
      return scale(*this, PlaneDistortion(distortion).differentiate(x.head<2>() / x.z()) * differentiate_plane(x));
    case CameraModel::fisheye:
      return scale(*this, differentiate_fisheye(AngleDistortion(distortion), x));
    case CameraModel::unified:
      return scale(*this, PlaneDistortion(distortion).differentiate(project_to_sphere(x, xi)) * differentiate_sphere(x, xi));
    case CameraModel::equirectangular:
    case CameraModel::cylindrical:
      return scale(*this, differentiate_panorama(*this, x));
  }
  return {};
}

Eigen::Vector3d Camera::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d d((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  switch (model) {
    case CameraModel::pinhole: {
      const Eigen::Vector2d n = is_distorted() ? PlaneDistortion(distortion).undistort(d) : d;
      return {n.x(), n.y(), 1};
    }
    case CameraModel::fisheye:
      return to_direction(AngleDistortion(distortion).angle(d.norm()), d);
    case CameraModel::unified:
      return lift_to_sphere(PlaneDistortion(distortion).undistort(d), xi);
    case CameraModel::equirectangular:
      return {std::cos(d.y()) * std::sin(d.x()), std::sin(d.y()), std::cos(d.y()) * std::cos(d.x())};
    case CameraModel::cylindrical:
      return Eigen::Vector3d(std::sin(d.x()), d.y(), std::cos(d.x())).normalized();
  }
  return {};
}

bool Camera::in_front(const Eigen::Vector3d& x) const {
  if (model == CameraModel::pinhole) {
    if (x.z() <= kNearest) return false;
    if (!is_distorted()) return true;
    return PlaneDistortion(distortion).increases_to((x.x() * x.x() + x.y() * x.y()) / (x.z() * x.z()));
  }
  const double length = x.norm();
  if (length <= kNearest) return false;
  if (model == CameraModel::fisheye) return AngleDistortion(distortion).increases_to(measure_angle(x));
  if (model == CameraModel::unified)
    return x.z() > find_lowest_z(xi) * length &&
           PlaneDistortion(distortion).increases_to(project_to_sphere(x, xi).squaredNorm());
  return true;
}

bool Camera::shows(const Eigen::Vector2d& pixel) const {
  constexpr double kTolerancePx = 0.5;
  const Eigen::Vector3d x = ray(pixel);
  return in_front(x) && (project(x) - pixel).norm() < kTolerancePx;
}

}  // namespace dvi
