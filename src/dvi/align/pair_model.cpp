#include "dvi/align/pair_model.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dvi/core/median.h"
#include "dvi/geometry/skew.h"

namespace dvi::align {
namespace {

constexpr double kCauchy = 2.385;  // 95 % efficient on normal noise
constexpr int kIterations = 10;    // a level
constexpr double kStill = 0.01;    // px: a step below it is the last
constexpr double kGrazing = 0.02;  // cosine: a surface seen flatter, or of unknown normal, is taken to face the camera
constexpr std::size_t kHeldOut = 4;
constexpr double kSmallestScale = 1e-3;  // of log brightness: nothing agrees better than rounding to 8 bits lets it

enum class Part { fitted, held_out };  // of a pair's points

Part part_of(std::size_t i) { return i % kHeldOut == kHeldOut - 1 ? Part::held_out : Part::fitted; }

cv::Size size_of(const PosedImage& view) { return {view.camera.width, view.camera.height}; }

// Derivative of Camera::project by the point.
Eigen::Matrix<double, 2, 3> project_derivative(const Camera& camera, const Eigen::Vector3d& point) {
  const double z = point.z(), x = point.x() / z, y = point.y() / z, r2 = x * x + y * y;
  Eigen::Matrix2d bent = Eigen::Matrix2d::Identity();
  if (camera.is_distorted()) {
    const auto [k1, k2, p1, p2, k3] = camera.distortion;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));
    const double both = x * y * slope + 2 * p1 * x + 2 * p2 * y;
    bent << radial + x * x * slope + 2 * p1 * y + 6 * p2 * x, both, both, radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  }
  Eigen::Matrix<double, 2, 3> flat;
  flat << 1 / z, 0, -x / z, 0, 1 / z, -y / z;
  return Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * bent * flat;
}

// A point that both views show: what the fixed one has there, where it is for the moving one.
struct Point {
  const SurfacePoint* surfel;
  Eigen::Vector3d in_moving;
  double color = 0;
};

std::vector<Point> common_points(const Pair& pair, const PosedImage& moving, const PosedImage& fixed, std::size_t level,
                                 Part part) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < pair.seen.size(); ++i) {
    if (part_of(i) != part) continue;
    const SurfacePoint& surfel = (*pair.points)[pair.seen[i]];
    const Eigen::Vector3d world = surfel.position.cast<double>();
    const Eigen::Vector3d p = fixed.camera_from_world * world;
    if (!fixed.camera.in_front(p)) continue;
    const Eigen::Vector2d pixel = fixed.camera.project(p);
    if (!fixed.camera.contains(pixel)) continue;
    const Eigen::Vector3d q = moving.camera_from_world * world;
    if (!moving.camera.in_front(q) || !moving.camera.contains(moving.camera.project(q))) continue;
    points.push_back({&surfel, q, spot_at((*fixed.image)[level], size_of(fixed), pixel).value});
  }
  return points;
}

double scale_of(const std::vector<double>& residuals) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (const double r : residuals) sizes.push_back(std::abs(r));
  return std::max(kSmallestScale, 1.4826 * median(std::move(sizes)));
}

// Residuals and their derivative by the moving view's rotation; a point that leaves the image has none.
struct Residuals {
  std::vector<double> r;
  std::vector<Eigen::RowVector3d> J;
};

Residuals residuals(const std::vector<Point>& points, const PosedImage& moving, std::size_t level, const Eigen::Matrix3d& R) {
  Residuals out;
  out.r.reserve(points.size());
  out.J.reserve(points.size());
  for (const Point& point : points) {
    const Eigen::Vector3d p = R * point.in_moving;
    const Spot spot = spot_at((*moving.image)[level], size_of(moving), moving.camera.project(p));
    out.r.push_back(spot.value - point.color);
    out.J.emplace_back(-(spot.slope * project_derivative(moving.camera, p)) * skew(p));
  }
  return out;
}

double weight(double r, double scale) { return 1 / (1 + std::pow(r / (kCauchy * scale), 2)); }
double cost(double r, double scale) { return std::log1p(std::pow(r / (kCauchy * scale), 2)); }

// The sum of all costs, a logarithm for every eight.
double cost(const std::vector<double>& residuals, double scale) {
  double sum = 0, product = 1;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    product *= 1 + std::pow(residuals[i] / (kCauchy * scale), 2);
    if (i % 8 != 7 && i + 1 < residuals.size()) continue;
    sum += std::log(product);
    product = 1;
  }
  return sum;
}

// Gauss-Newton on one level, from w on.
Eigen::Vector3d refine(const std::vector<Point>& points, const PosedImage& moving, std::size_t level, double expected,
                       Eigen::Vector3d w) {
  double scale = 0, best = 0;
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int i = 0; i < kIterations; ++i) {
    const Residuals now = residuals(points, moving, level, so3_exp(w + step));
    if (i == 0) scale = scale_of(now.r);
    const double total = 0.5 * (w + step).squaredNorm() / (expected * expected) + 0.5 * kCauchy * kCauchy * cost(now.r, scale);
    if (i > 0 && total >= best) return w;
    Eigen::Matrix3d H = Eigen::Matrix3d::Identity() / (expected * expected);
    Eigen::Vector3d g = (w + step) / (expected * expected);
    for (std::size_t k = 0; k < now.r.size(); ++k) {
      const double by = weight(now.r[k], scale) / (scale * scale);
      H += by * now.J[k].transpose() * now.J[k];
      g += by * now.r[k] * now.J[k].transpose();
    }
    best = total;
    w += step;
    step = -H.ldlt().solve(g);
    if (step.norm() * moving.camera.fx < kStill) return w + step;
  }
  return w;
}

// Where on the surface the fixed view finds the color if the point q moves in its axes: along the ray nothing changes. The
// slope of the fixed image is not used: its noise, in the product of both slopes, would hold every view where it is.
Eigen::Matrix3d along_surface(const SurfacePoint& surfel, const PosedImage& fixed, const Eigen::Vector3d& q) {
  Eigen::Vector3d normal = fixed.camera_from_world.R * surfel.normal.cast<double>();
  if (std::abs(normal.dot(q)) < kGrazing * q.norm()) normal = q;
  return Eigen::Matrix3d::Identity() - q * normal.transpose() / normal.dot(q);
}

// The quadratic where the moving view is turned by w: N corrections a view.
template <int N>
PairModel model_at(const Eigen::Vector3d& w, const Pair& pair, const std::vector<Point>& points, const PosedImage& moving,
                   const PosedImage& fixed) {
  const Eigen::Matrix3d R = so3_exp(w);
  const Residuals last = residuals(points, moving, 0, R);
  const Eigen::Matrix3d moving_from_fixed = R * moving.camera_from_world.R * fixed.camera_from_world.R.transpose();
  Eigen::Matrix<double, 2 * N, 2 * N> H = Eigen::Matrix<double, 2 * N, 2 * N>::Zero();
  Eigen::Matrix<double, 2 * N, 1> g = Eigen::Matrix<double, 2 * N, 1>::Zero();
  const double scale = scale_of(last.r);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d p = R * points[k].in_moving, q = fixed.camera_from_world * points[k].surfel->position.cast<double>();
    const Eigen::RowVector3d by_p =
        spot_at((*moving.image)[0], size_of(moving), moving.camera.project(p)).slope * project_derivative(moving.camera, p);
    const Eigen::RowVector3d by_q = -by_p * moving_from_fixed * along_surface(*points[k].surfel, fixed, q);
    Eigen::Matrix<double, 1, 2 * N> J;
    if constexpr (N == 3)
      J << -by_p * skew(p), -by_q * skew(q);
    else
      J << -by_p * skew(p), by_p, -by_q * skew(q), by_q;
    const double by = weight(last.r[k], scale) / (scale * scale);
    H += by * J.transpose() * J;
    g += by * last.r[k] * J.transpose();
  }
  g -= H.template leftCols<3>() * w;  // from the fitted place back to the given one
  return {pair.moving, pair.fixed, H, g, scale};
}

}  // namespace

std::optional<PairModel> fit_pair(const Pair& pair, const PosedImage& moving, const PosedImage& fixed, std::size_t coarsest,
                                  double expected, Freedom freedom) {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  std::vector<Point> points;
  for (std::size_t level = coarsest + 1; level-- > 0;) {
    points = common_points(pair, moving, fixed, level, Part::fitted);
    if (points.size() < kFewestPoints) return std::nullopt;
    w = refine(points, moving, level, expected, w);
  }
  return freedom == Freedom::pose ? model_at<6>(w, pair, points, moving, fixed) : model_at<3>(w, pair, points, moving, fixed);
}

HeldOutCost held_out(const Pair& pair, const PosedImage& moving, const PosedImage& fixed, double scale) {
  HeldOutCost out;
  const std::vector<Point> points = common_points(pair, moving, fixed, 0, Part::held_out);
  for (const Point& point : points) {
    const Spot spot = spot_at((*moving.image)[0], size_of(moving), moving.camera.project(point.in_moving));
    const double r = spot.value - point.color;
    out.cost += cost(r, scale);
    out.offsets_px.push_back(std::abs(r) / std::max(1e-6, spot.slope.norm()));
  }
  out.points = static_cast<int>(points.size());
  if (out.points > 0) out.cost /= out.points;
  return out;
}

}  // namespace dvi::align
