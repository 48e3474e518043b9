#include "dvi/scan_match/register_scan.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace dvi::scan_match {
namespace {

// The normal equations of one iteration.
struct Sums {
  const Eigen::Vector3d center;  // the origin of the rotation
  const double noise2, kernel2;
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double squares = 0;
  std::size_t inliers = 0;

  void add(const Shape& shape, const Eigen::Vector3d& p) {
    const Eigen::Vector3d off = p - shape.mean;
    for (int k = 0; k < shape.thin; ++k) {
      const Eigen::Vector3d axis = shape.axes.col(k);
      const double r = axis.dot(off);
      const double across = shape.variance[k] + noise2;
      // The uncertainty of the surface grows with the distance from the points that it was fitted to.
      double s2 = across;
      for (int j = shape.thin; j < 3; ++j) {
        const double along = shape.axes.col(j).dot(off);
        s2 += across / shape.count * along * along / shape.variance[j];
      }
      const double k2 = kernel2 + 4 * (s2 - noise2);
      const double robust = k2 / (k2 + r * r);
      const double weight = robust * robust / s2;
      Vector6d J;
      J.head<3>() = axis;
      J.tail<3>() = (p - center).cross(axis);
      H.selfadjointView<Eigen::Lower>().rankUpdate(J, weight);
      b -= weight * r * J;
      if (r * r < k2) squares += r * r, ++inliers;
    }
  }
};

// Returns the directions of translation, with free rotation, that have almost no information, as columns.
Eigen::Matrix3Xd find_loose_directions(const Matrix6d& H) {
  constexpr double kMaxLooseShare = 0.002;
  const Eigen::Matrix3d turning = H.bottomRightCorner<3, 3>() + 1e-9 * H.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d held =
      H.topLeftCorner<3, 3>() - H.topRightCorner<3, 3>() * turning.ldlt().solve(H.bottomLeftCorner<3, 3>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(held);  // eigenvalues in increasing order
  return solver.eigenvectors().leftCols(
      (solver.eigenvalues().array() < kMaxLooseShare * H.topLeftCorner<3, 3>().trace()).count());
}

}  // namespace

Eigen::Vector3d compensate(const Feature& feature, const Vector6d& twist) {
  const Eigen::Vector3d p = feature.point.cast<double>(), w = twist.tail<3>();
  const double t = feature.time;
  const Eigen::Vector3d velocity = twist.head<3>() + w.cross(p);
  return p + t * velocity + 0.5 * t * t * w.cross(velocity);  // the exponential map to second order
}

void LocalMaps::add(const Features& features, const SE3& world_from_lidar, const Vector6d& twist) {
  for (const Feature& f : features.planes) {
    const Eigen::Vector3d p = world_from_lidar * compensate(f, twist);
    fine.add(p);
    coarse.add(p);
  }
  for (const Feature& f : features.edges) edges.add(world_from_lidar * compensate(f, twist));
}

void LocalMaps::remove(const Features& features, const SE3& world_from_lidar, const Vector6d& twist) {
  for (const Feature& f : features.planes) {
    const Eigen::Vector3d p = world_from_lidar * compensate(f, twist);
    fine.remove(p);
    coarse.remove(p);
  }
  for (const Feature& f : features.edges) edges.remove(world_from_lidar * compensate(f, twist));
}

void LocalMaps::keep_near(const Eigen::Vector3d& position, double radius_m) {
  for (LocalMap* map : {&fine, &coarse, &edges}) map->keep_near(position, radius_m);
}

Registration register_scan(const Features& features, const ScanGuess& guess, LocalMaps& scene, const RegisterOptions& options) {
  Registration out;
  SE3 pose = guess.world_from_lidar;
  const auto compute_twist = [&] {
    return guess.seconds > 0 ? Vector6d(se3_log(guess.before.inverse() * pose) / guess.seconds) : guess.twist;
  };
  Vector6d prior;
  prior << Eigen::Vector3d::Constant(1 / (options.prior_m * options.prior_m)),
      Eigen::Vector3d::Constant(100 / (options.prior_m * options.prior_m));
  const double noise2 = options.noise_m * options.noise_m;
  Matrix6d held = prior.asDiagonal();
  out.features = features.planes.size() + features.edges.size();
  for (int i = 0; i < options.iterations; ++i) {
    const bool coarse = i < options.coarse_iterations;
    const double kernel =
        coarse ? 10 * options.kernel_m : options.kernel_m * std::max(1.0, 4.0 / (1 + i - options.coarse_iterations));
    const double kernel2 = kernel * kernel;
    out.twist = compute_twist();
    Sums sums{.center = pose.t, .noise2 = noise2, .kernel2 = kernel2};
    for (const Feature& f : features.planes) {
      const Eigen::Vector3d p = pose * compensate(f, out.twist);
      const Shape* shape = coarse ? nullptr : scene.fine.at(p, 1);
      if (shape == nullptr) shape = scene.coarse.at(p, 1);
      if (shape != nullptr) sums.add(*shape, p);
    }
    for (const Feature& f : features.edges) {
      const Eigen::Vector3d p = pose * compensate(f, out.twist);
      if (const Shape* shape = scene.edges.at(p, 2)) sums.add(*shape, p);
    }
    out.inliers = sums.inliers;
    if (sums.inliers < 20) break;
    out.residual_m = std::sqrt(sums.squares / static_cast<double>(sums.inliers));
    const Matrix6d H = sums.H.selfadjointView<Eigen::Lower>();
    const Eigen::Matrix3Xd loose = find_loose_directions(H);
    out.degenerate = static_cast<int>(loose.cols());
    Vector6d from_guess;
    from_guess << pose.t - guess.world_from_lidar.t, so3_log(pose.R * guess.world_from_lidar.R.transpose());
    held = H + prior.asDiagonal().toDenseMatrix();
    Matrix6d stay = prior.asDiagonal();
    if (options.keeps_guess) stay.topLeftCorner<3, 3>() += H.trace() * loose * loose.transpose();
    const Vector6d step = (H + stay).ldlt().solve(sums.b - stay * from_guess);
    pose.t += step.head<3>();
    pose.R = so3_exp(step.tail<3>()) * pose.R;
    if (i >= options.coarse_iterations + 3 && step.head<3>().norm() < 3e-4 && step.tail<3>().norm() < 1e-5) break;
  }
  out.twist = compute_twist();
  out.world_from_lidar = pose;
  for (const int i : {0, 3})
    for (const int j : {0, 3}) out.information.block<3, 3>(i, j) = pose.R.transpose() * held.block<3, 3>(i, j) * pose.R;
  return out;
}

double compute_scene_share(const Features& features, const Registration& registration, LocalMaps& scene, double on_m) {
  constexpr double kMinLevelCosine = 0.8;
  std::size_t on = 0, all = features.edges.size();
  const auto lies_on = [&](const Shape* shape, const Eigen::Vector3d& p) {
    return shape != nullptr && (shape->axes.leftCols(shape->thin).transpose() * (p - shape->mean)).norm() < on_m;
  };
  for (const Feature& f : features.planes) {
    const Eigen::Vector3d p = registration.world_from_lidar * compensate(f, registration.twist);
    const Shape* shape = scene.fine.at(p, 1);
    if (shape == nullptr) shape = scene.coarse.at(p, 1);
    const bool found = lies_on(shape, p);
    if (found && std::abs(shape->axes(2, 0)) > kMinLevelCosine) continue;
    ++all;
    on += found ? 1 : 0;
  }
  for (const Feature& f : features.edges) {
    const Eigen::Vector3d p = registration.world_from_lidar * compensate(f, registration.twist);
    on += lies_on(scene.edges.at(p, 2), p) ? 1 : 0;
  }
  return static_cast<double>(on) / static_cast<double>(std::max<std::size_t>(all, 1));
}

}  // namespace dvi::scan_match
