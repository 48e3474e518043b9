#include "dvi/align/pair_model.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dvi/core/statistics.h"
#include "dvi/geometry/skew.h"

namespace dvi::align {
namespace {

constexpr double kCauchy = 2.385;   // 95 % efficient for normal noise
constexpr int kMaxIterations = 10;  // per level
constexpr double kConvergedPx = 0.01;
constexpr double kMinCosine = 0.02;  // cosine of the viewing angle; otherwise the surface is assumed to face the camera
constexpr std::size_t kHeldOutStep = 4;
constexpr double kMinScale = 1e-3;  // in the logarithm of brightness, because of the rounding to 8 bits

enum class PointSet { fitted, held_out };

PointSet get_set(std::size_t i) { return i % kHeldOutStep == kHeldOutStep - 1 ? PointSet::held_out : PointSet::fitted; }

cv::Size get_size(const PosedImage& view) { return {view.camera.width, view.camera.height}; }

/// A point in both views: its position in the moving view, and its value in the fixed view.
struct CommonPoint {
  const SurfacePoint* surfel;
  Eigen::Vector3d in_moving;
  double value = 0;
};

/// The common points of a pair on one level of the images.
struct CommonPoints {
  const PosedImage* moving;
  std::size_t level;
  std::vector<CommonPoint> points;
};

CommonPoints find_common_points(const PosedPair& posed, std::size_t level, PointSet set) {
  const auto& [pair, moving, fixed] = posed;
  CommonPoints out{&moving, level, {}};
  for (std::size_t i = 0; i < pair.visible.size(); ++i) {
    if (get_set(i) != set) continue;
    const SurfacePoint& surfel = (*pair.points)[pair.visible[i]];
    const Eigen::Vector3d world = surfel.position.cast<double>();
    const Eigen::Vector3d p = fixed.camera_from_world * world;
    if (!fixed.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = fixed.camera.project(p);
    if (!fixed.camera.contains(pixel)) continue;
    const Eigen::Vector3d q = moving.camera_from_world * world;
    if (!moving.camera.in_front(q) || !moving.camera.contains(moving.camera.project(q))) continue;
    out.points.push_back({&surfel, q, sample((*fixed.image)[level], get_size(fixed), pixel).value});
  }
  return out;
}

double estimate_scale(const std::vector<double>& residuals) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (const double r : residuals) sizes.push_back(std::abs(r));
  return std::max(kMinScale, estimate_sigma(std::move(sizes)));
}

/// The residuals and their derivatives with respect to the rotation of the moving view.
struct Residuals {
  std::vector<double> r;
  std::vector<Eigen::RowVector3d> J;
};

Residuals compute_residuals(const CommonPoints& common, const Eigen::Matrix3d& R) {
  const auto& [moving_image, level, points] = common;
  const PosedImage& moving = *moving_image;
  Residuals out;
  out.r.reserve(points.size());
  out.J.reserve(points.size());
  for (const CommonPoint& point : points) {
    const Eigen::Vector3d p = R * point.in_moving;
    const ValueAndSlope spot = sample((*moving.image)[level], get_size(moving), moving.camera.project(p));
    out.r.push_back(spot.value - point.value);
    out.J.emplace_back(-(spot.slope * moving.camera.differentiate(p)) * skew(p));
  }
  return out;
}

double compute_weight(double r, double scale) { return 1 / (1 + std::pow(r / (kCauchy * scale), 2)); }
double compute_cost(double r, double scale) { return std::log1p(std::pow(r / (kCauchy * scale), 2)); }

/// Computes the sum of all costs, with one logarithm for eight residuals.
double sum_costs(const std::vector<double>& residuals, double scale) {
  double sum = 0, product = 1;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    product *= 1 + std::pow(residuals[i] / (kCauchy * scale), 2);
    if (i % 8 != 7 && i + 1 < residuals.size()) continue;
    sum += std::log(product);
    product = 1;
  }
  return sum;
}

/// Runs Gauss-Newton on one level, starting from rotation w.
Eigen::Vector3d refine(const CommonPoints& points, double expected, Eigen::Vector3d w) {
  double scale = 0, best = 0;
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int i = 0; i < kMaxIterations; ++i) {
    const Residuals now = compute_residuals(points, so3_exp(w + step));
    if (i == 0) scale = estimate_scale(now.r);
    const double total =
        0.5 * (w + step).squaredNorm() / (expected * expected) + 0.5 * kCauchy * kCauchy * sum_costs(now.r, scale);
    if (i > 0 && total >= best) return w;
    Eigen::Matrix3d H = Eigen::Matrix3d::Identity() / (expected * expected);
    Eigen::Vector3d g = (w + step) / (expected * expected);
    for (std::size_t k = 0; k < now.r.size(); ++k) {
      const double by = compute_weight(now.r[k], scale) / (scale * scale);
      H += by * now.J[k].transpose() * now.J[k];
      g += by * now.r[k] * now.J[k].transpose();
    }
    best = total;
    w += step;
    step = -H.ldlt().solve(g);
    if (step.norm() * points.moving->camera.fx < kConvergedPx) return w + step;
  }
  return w;
}

/// Returns the derivative of the surface point that the fixed view shows at a pixel with respect to a motion of the point q in
/// its axes; a motion along the ray has no effect. The slope of the fixed image is not used, because the noise in the product
/// of both slopes would bias all corrections to zero.
Eigen::Matrix3d differentiate_along_surface(const SurfacePoint& surfel, const PosedImage& fixed, const Eigen::Vector3d& q) {
  Eigen::Vector3d normal = fixed.camera_from_world.R * surfel.normal.cast<double>();
  if (std::abs(normal.dot(q)) < kMinCosine * q.norm()) normal = q;
  return Eigen::Matrix3d::Identity() - q * normal.transpose() / normal.dot(q);
}

/// Makes the model with the moving view rotated by w; a view has N corrections.
template <int N>
PairModel make_model(const Eigen::Vector3d& w, const PosedPair& posed, const CommonPoints& common) {
  const auto& [pair, moving, fixed] = posed;
  const std::vector<CommonPoint>& points = common.points;
  const Eigen::Matrix3d R = so3_exp(w);
  const Residuals last = compute_residuals(common, R);
  const Eigen::Matrix3d moving_from_fixed = R * moving.camera_from_world.R * fixed.camera_from_world.R.transpose();
  Eigen::Matrix<double, 2 * N, 2 * N> H = Eigen::Matrix<double, 2 * N, 2 * N>::Zero();
  Eigen::Matrix<double, 2 * N, 1> g = Eigen::Matrix<double, 2 * N, 1>::Zero();
  const double scale = estimate_scale(last.r);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d p = R * points[k].in_moving, q = fixed.camera_from_world * points[k].surfel->position.cast<double>();
    const Eigen::RowVector3d by_p =
        sample((*moving.image)[0], get_size(moving), moving.camera.project(p)).slope * moving.camera.differentiate(p);
    const Eigen::RowVector3d by_q = -by_p * moving_from_fixed * differentiate_along_surface(*points[k].surfel, fixed, q);
    Eigen::Matrix<double, 1, 2 * N> J;
    if constexpr (N == 3)
      J << -by_p * skew(p), -by_q * skew(q);
    else
      J << -by_p * skew(p), by_p, -by_q * skew(q), by_q;
    const double by = compute_weight(last.r[k], scale) / (scale * scale);
    H += by * J.transpose() * J;
    g += by * last.r[k] * J.transpose();
  }
  g -= H.template leftCols<3>() * w;  // from the fitted rotation back to the given pose
  return {pair.moving, pair.fixed, H, g, scale};
}

}  // namespace

std::optional<PairModel> fit_pair(const PosedPair& pair, std::size_t coarsest, double expected, Freedom freedom) {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  CommonPoints common;
  for (std::size_t level = coarsest + 1; level-- > 0;) {
    common = find_common_points(pair, level, PointSet::fitted);
    if (common.points.size() < kMinPairPoints) return std::nullopt;
    w = refine(common, expected, w);
  }
  return freedom == Freedom::pose ? make_model<6>(w, pair, common) : make_model<3>(w, pair, common);
}

HeldOutCost evaluate_held_out(const PosedPair& pair, double scale) {
  const PosedImage& moving = pair.moving;
  HeldOutCost out;
  const std::vector<CommonPoint> points = find_common_points(pair, 0, PointSet::held_out).points;
  for (const CommonPoint& point : points) {
    const ValueAndSlope spot = sample((*moving.image)[0], get_size(moving), moving.camera.project(point.in_moving));
    const double r = spot.value - point.value;
    out.cost += compute_cost(r, scale);
    out.offsets_px.push_back(std::abs(r) / std::max(1e-6, spot.slope.norm()));
  }
  out.points = static_cast<int>(points.size());
  if (out.points > 0) out.cost /= out.points;
  return out;
}

}  // namespace dvi::align
