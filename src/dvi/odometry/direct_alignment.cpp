#include "dvi/odometry/direct_alignment.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "dvi/image/interpolate.h"

namespace dvi::odometry {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr DirectAlignmentParams kDirect;

double compute_depth_noise_m(double depth) {
  return std::max(kDirect.min_depth_noise_m, kDirect.depth_noise_per_m * depth * depth);
}

/// Residuals of the points of a level, as far as they could be compared.
struct Residuals {
  struct Item {
    std::size_t point;
    float value;
  };
  std::vector<Item> gray, distance;
  std::vector<float> current_gray;  // as `gray`
  std::size_t visible = 0, occluded = 0;
};

struct Brightness {
  double gain = 1, offset = 0;
};

Residuals compare(const std::vector<ReferenceView::Point>& points, const RgbdLevel& current, const SE3& current_from_reference,
                  const Brightness& brightness) {
  Residuals out;
  const Eigen::Matrix3f R = current_from_reference.R.cast<float>();
  const Eigen::Vector3f t = current_from_reference.t.cast<float>();
  const auto gain = static_cast<float>(brightness.gain), offset = static_cast<float>(brightness.offset);
  const auto width = static_cast<float>(current.points.cols - 1), height = static_cast<float>(current.points.rows - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ReferenceView::Point& point = points[i];
    const Eigen::Vector3f p = R * point.x + t;
    if (!(p.z() > 0.05F)) continue;
    const Eigen::Vector2f at = current.camera.project(p);
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < width && at.y() < height)) continue;
    ++out.visible;
    const Eigen::Vector3f seen = current.point(static_cast<int>(at.y() + 0.5F), static_cast<int>(at.x() + 0.5F));
    if (seen.z() > 0) {
      if (std::abs(seen.z() - p.z()) > kDirect.occlusion_tolerance * p.z()) {
        ++out.occluded;
        continue;
      }
      if (point.normal.z() != 0) {
        const float noise = static_cast<float>(1.4 * compute_depth_noise_m(p.z()));
        out.distance.push_back({i, point.normal.dot(R.transpose() * (seen - t) - point.x) / noise});
      }
    }
    if (current.gray.empty() || std::isnan(point.gray)) continue;
    const float gray = bilinear(current.gray, cv::Point2f(at.x(), at.y()));
    out.gray.push_back({i, gray - gain * point.gray - offset});
    out.current_gray.push_back(gray);
  }
  return out;
}

/// The scale of Student's t-distribution that fits the residuals best.
double fit_student_scale(const std::vector<Residuals::Item>& residuals, double min_scale) {
  if (residuals.empty()) return min_scale;
  double squares = 0;
  for (const Residuals::Item& r : residuals) squares += r.value * r.value;
  double variance = squares / static_cast<double>(residuals.size());
  for (int i = 0; i < 8; ++i) {
    double sum = 0;
    for (const Residuals::Item& r : residuals) {
      const double r2 = static_cast<double>(r.value) * r.value;
      sum += r2 * (kDirect.degrees_of_freedom + 1) / (kDirect.degrees_of_freedom + r2 / variance);
    }
    variance = std::max(sum / static_cast<double>(residuals.size()), min_scale * min_scale);
  }
  return std::sqrt(variance);
}

double compute_student_weight(double residual, double scale) {
  const double r2 = residual * residual / (scale * scale);
  return (kDirect.degrees_of_freedom + 1) / (kDirect.degrees_of_freedom + r2) / (scale * scale);
}

/// Normal equations in the motion of the reference's points, gain and offset.
struct Equations {
  Matrix8d H = Matrix8d::Zero();
  Vector8d b = Vector8d::Zero();

  Matrix6d information() const {
    const Matrix8d full = H.selfadjointView<Eigen::Lower>();
    const Eigen::Matrix2d bright = full.bottomRightCorner<2, 2>() + 1e-9 * Eigen::Matrix2d::Identity();
    return full.topLeftCorner<6, 6>() - full.topRightCorner<6, 2>() * bright.inverse() * full.bottomLeftCorner<2, 6>();
  }
};

Equations build_equations(const std::vector<ReferenceView::Point>& points, const Residuals& residuals,
                          const Brightness& brightness) {
  Equations out;
  auto lower = out.H.selfadjointView<Eigen::Lower>();
  const double gray_scale = fit_student_scale(residuals.gray, kDirect.min_gray_noise);
  for (const Residuals::Item& r : residuals.gray) {
    Vector8d J;
    J << -brightness.gain * points[r.point].by_gray, -points[r.point].gray / 100.0, -1;
    const double weight = compute_student_weight(r.value, gray_scale);
    lower.rankUpdate(J, weight);
    out.b -= weight * r.value * J;
  }
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  const double distance_scale = fit_student_scale(residuals.distance, 1);
  for (const Residuals::Item& r : residuals.distance) {
    const ReferenceView::Point& point = points[r.point];
    const double inverse_noise = 1 / (1.4 * compute_depth_noise_m(point.x.z()));
    const double weight = compute_student_weight(r.value, distance_scale);
    H.selfadjointView<Eigen::Lower>().rankUpdate(point.by_distance, weight * inverse_noise * inverse_noise);
    b -= weight * inverse_noise * r.value * point.by_distance;
  }
  out.H.topLeftCorner<6, 6>() += H;
  out.b.head<6>() += b;
  return out;
}

double compute_truncated_cost(const Residuals& residuals, std::size_t points) {
  double gray = 0, distance = 0, n_gray = 0, n_distance = 0;
  for (const Residuals::Item& r : residuals.gray)
    gray += std::min(1.0, r.value * r.value / (kDirect.max_cost_gray * kDirect.max_cost_gray)), ++n_gray;
  for (const Residuals::Item& r : residuals.distance)
    distance += std::min(1.0, r.value * r.value / (kDirect.max_cost_sigmas * kDirect.max_cost_sigmas)), ++n_distance;
  const auto hidden = static_cast<double>(residuals.occluded);
  double sum = 0, parts = 0;
  if (n_gray > 0) sum += (gray + hidden) / (n_gray + hidden), ++parts;
  if (n_distance > 0) sum += (distance + hidden) / (n_distance + hidden), ++parts;
  const double seen = static_cast<double>(residuals.visible) / static_cast<double>(std::max<std::size_t>(points, 1));
  return parts > 0 ? seen * sum / parts + (1 - seen) * kDirect.cost_outside : 1;
}

double compute_correlation(const std::vector<ReferenceView::Point>& points, const Residuals& residuals) {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t k = 0; k < residuals.gray.size(); ++k) {
    const double x = points[residuals.gray[k].point].gray, y = residuals.current_gray[k];
    n += 1, a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
  }
  if (n == 0) return 0;
  const double va = aa / n - a / n * a / n, vb = bb / n - b / n * b / n;
  if (std::max(va, vb) < kDirect.uniform_gray * kDirect.uniform_gray) return 1;
  return va > 1e-6 && vb > 1e-6 ? (ab / n - a / n * b / n) / std::sqrt(va * vb) : 0;
}

void set_agreement(const std::vector<ReferenceView::Point>& points, const Residuals& residuals, Alignment& out) {
  out.points = points.size();
  out.visible = residuals.visible;
  out.compared = residuals.distance.size() + residuals.occluded;
  out.inliers = 0;
  double squares = 0;
  for (const Residuals::Item& r : residuals.distance)
    if (std::abs(r.value) < kDirect.max_inlier_sigmas) {
      const double distance = r.value * 1.4 * compute_depth_noise_m(points[r.point].x.z());
      squares += distance * distance, ++out.inliers;
    }
  if (out.inliers > 0) out.residual_m = std::sqrt(squares / static_cast<double>(out.inliers));
  out.gray_points = residuals.gray.size();
  out.correlation = compute_correlation(points, residuals);
  out.cost = compute_truncated_cost(residuals, points.size());
}

Vector8d limit_step(Vector8d step) {
  const double excess = std::max(step.head<3>().norm() / kDirect.max_step_m, step.segment<3>(3).norm() / kDirect.max_step_rad);
  if (excess > 1) step.head<6>() /= excess;
  return step;
}

void align_on_level(const std::vector<ReferenceView::Point>& points, const RgbdLevel& current, Brightness& brightness,
                    Alignment& out) {
  for (int i = 0; i < kDirect.max_iterations; ++i) {
    const Residuals residuals = compare(points, current, out.reference_from_current.inverse(), brightness);
    const Equations equations = build_equations(points, residuals, brightness);
    Vector8d prior = Vector8d::Constant(kDirect.prior);
    prior[6] = prior[7] = 1;
    const Matrix8d H = Matrix8d(equations.H.selfadjointView<Eigen::Lower>()) + Matrix8d(prior.asDiagonal());
    const Vector8d step = limit_step(H.ldlt().solve(equations.b));
    out.reference_from_current = se3_exp(step.head<6>()) * out.reference_from_current;
    brightness.gain = std::clamp(brightness.gain + step[6] / 100, 0.3, 3.0);
    brightness.offset = std::clamp(brightness.offset + step[7], -150.0, 150.0);
    if (current.camera.fx * (step.head<3>().norm() + step.segment<3>(3).norm()) < kDirect.converged_px) break;
  }
}

}  // namespace

ReferenceView::ReferenceView(const RgbdImage& image) {
  for (std::size_t l = 0; l < image.levels.size(); ++l) {
    const RgbdLevel& level = image.levels[l];
    const cv::Mat3f normals = compute_normals(level, l == 0 ? 4 : l == 1 ? 2 : 1);
    std::vector<Point>& out = levels_.emplace_back();
    const cv::Size size = level.points.size();
    int block = 1;
    while (static_cast<std::size_t>(size.area() / (block * block)) > kDirect.max_points_per_level) ++block;
    const auto gradient = [&](int y, int x) -> Eigen::Vector2f {
      if (level.gray.empty()) return {0, 0};
      return 0.5F * Eigen::Vector2f(level.gray(y, x + 1) - level.gray(y, x - 1), level.gray(y + 1, x) - level.gray(y - 1, x));
    };
    for (int top = 1; top + block < size.height; top += block)
      for (int left = 1; left + block < size.width; left += block) {
        // The point with the strongest gradient constrains the motion most.
        float strongest = -1;
        cv::Point best;
        for (int y = top; y < top + block; ++y)
          for (int x = left; x < left + block; ++x)
            if (level.points(y, x)[2] > 0)
              if (const float strength = gradient(y, x).squaredNorm(); strength > strongest)
                strongest = strength, best = {x, y};
        if (strongest < 0) continue;
        Point point;
        point.x = level.point(best.y, best.x);
        const cv::Vec3f& n = normals(best.y, best.x);
        point.normal = {n[0], n[1], n[2]};
        const Eigen::Vector3d x = point.x.cast<double>(), normal = point.normal.cast<double>();
        point.by_distance << normal, x.cross(normal);
        const Eigen::Vector2f at = level.camera.project(point.x);
        if (!(at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<float>(size.width - 1) &&
              at.y() < static_cast<float>(size.height - 1)))
          continue;
        point.by_gray.setZero();
        if (image.has_gray()) {
          point.gray = bilinear(level.gray, cv::Point2f(at.x(), at.y()));
          Eigen::Vector2d g = gradient(best.y, best.x).cast<double>();
          if (strongest < kDirect.min_gradient * kDirect.min_gradient) g.setZero();
          const double gx = g.x() * level.camera.fx / x.z(), gy = g.y() * level.camera.fy / x.z();
          const Eigen::Vector3d by_place(gx, gy, -(gx * x.x() + gy * x.y()) / x.z());
          point.by_gray << by_place, x.cross(by_place);
        }
        out.push_back(point);
      }
  }
}

Alignment align(const ReferenceView& reference, const RgbdImage& current, const SE3& reference_from_current,
                const LevelRange& range) {
  Alignment out;
  out.reference_from_current = reference_from_current;
  Brightness brightness;
  const std::size_t levels = std::min(reference.levels().size(), current.levels.size());
  if (levels == 0) return out;
  const std::size_t finest = std::min(range.finest, levels - 1);
  for (std::size_t l = std::min(range.coarsest, levels - 1) + 1; l-- > finest;)
    align_on_level(reference.levels()[l], current.levels[l], brightness, out);
  const std::vector<ReferenceView::Point>& points = reference.levels()[finest];
  const SE3 current_from_reference = out.reference_from_current.inverse();
  const Residuals residuals = compare(points, current.levels[finest], current_from_reference, brightness);
  const std::vector<ReferenceView::Point>& coarse = reference.levels()[levels - 1];
  const Residuals coarse_residuals = compare(coarse, current.levels[levels - 1], current_from_reference, brightness);
  out.information = build_equations(coarse, coarse_residuals, brightness).information();
  out.gain = brightness.gain;
  out.offset = brightness.offset;
  set_agreement(points, residuals, out);
  return out;
}

}  // namespace dvi::odometry
