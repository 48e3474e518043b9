#include "dvi/diagnostics/camera_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"

namespace dvi::diagnostics {
namespace {

/// The steps of the numeric derivatives: about one pixel.
const Eigen::Vector4d& get_step() {
  static const Eigen::Vector4d value(0.002, 0.002, 0.002, 0.01);
  return value;
}

/// The largest change in one iteration.
const Eigen::Vector4d& get_max_change() {
  static const Eigen::Vector4d value(0.03, 0.03, 0.03, 0.1);
  return value;
}

/// camera_from_world at two images.
struct Motion {
  SE3 from, to;
};

std::optional<Motion> compute_motion(const FlowPair& pair, const SE3& camera_from_lidar, const CameraError& error) {
  const auto late_ns = static_cast<std::int64_t>(std::llround(1e9 * error[3]));
  const auto from = pair.world_from_lidar.at(pair.from_ns - late_ns), to = pair.world_from_lidar.at(pair.to_ns - late_ns);
  if (!from || !to) return std::nullopt;
  const SE3 rotated = SE3{so3_exp(error.head<3>()), Eigen::Vector3d::Zero()} * camera_from_lidar;
  return Motion{rotated * from->inverse(), rotated * to->inverse()};
}

bool is_in_front(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  return camera.depth(x_in_camera) > kCameraFit.min_depth_m && camera.in_front(x_in_camera);
}

/// Computes the observed minus the predicted flow at a return, in units of its error; nothing if the flow is unknown.
std::optional<Eigen::Vector2d> compute_residual(const Camera& camera, const Motion& motion, const cv::Mat2f& flow,
                                                const Eigen::Vector3d& x) {
  const Eigen::Vector3d a = motion.from * x, b = motion.to * x;
  if (!is_in_front(camera, a) || !is_in_front(camera, b)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(a);
  if (!camera.contains(pixel)) return std::nullopt;
  const cv::Vec2f& seen = flow(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
  if (std::isnan(seen[0])) return std::nullopt;
  const Eigen::Vector2d observed(seen[0], seen[1]);
  return (observed - (camera.project(b) - pixel)) / (kCameraFit.flow_error_px + kCameraFit.depth_error_share * observed.norm());
}

/// The normal equations of one pair; parts that are not free stay zero.
struct PairEquations {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
};

}  // namespace

CameraFit::CameraFit(const FlowPairs& pairs, const Camera& camera, const SE3& camera_from_lidar)
    : pairs_(pairs), camera_(camera), camera_from_lidar_(camera_from_lidar), near_(pairs.pairs.size()) {
  const double border = kCameraFit.border_widths * camera.width;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const auto motion = compute_motion(pairs.pairs[i], camera_from_lidar, CameraError::Zero());
    if (!motion) continue;
    std::vector<Eigen::Vector3d> all;
    for (const Eigen::Vector3d& x : pairs.pairs[i].returns) {
      const Eigen::Vector3d x_in_camera = motion->from * x;
      if (!is_in_front(camera, x_in_camera)) continue;
      const Eigen::Vector2d p = camera.project(x_in_camera);
      if (p.x() > -border && p.y() > -border && p.x() < camera.width + border && p.y() < camera.height + border)
        all.push_back(x);
    }
    const std::size_t every = all.size() / kCameraFit.max_returns + 1;
    for (std::size_t k = 0; k < all.size(); k += every) near_[i].push_back(all[k]);
  }
}

std::vector<double> CameraFit::costs(const CameraError& error) const {
  std::vector<double> out(near_.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(near_.size(), [&](std::size_t i) {
    const FlowPair& pair = pairs_.pairs[i];
    const auto motion = compute_motion(pair, camera_from_lidar_, error);
    if (!motion) return;
    double sum = 0;
    std::size_t n = 0;
    for (const Eigen::Vector3d& x : near_[i]) {
      const auto r = compute_residual(camera_, *motion, pair.flow, x);
      if (!r) continue;
      sum += r->squaredNorm() / (1 + r->squaredNorm());
      ++n;
    }
    out[i] = n >= kCameraFit.min_returns ? sum / static_cast<double>(n) : 1;
  });
  return out;
}

double CameraFit::cost(const CameraError& error) const {
  double sum = 0;
  std::size_t known = 0;
  for (const double cost : costs(error))
    if (!std::isnan(cost)) sum += cost, ++known;
  return known > 0 && 2 * known >= near_.size() ? sum / static_cast<double>(known) : 1;
}

CameraError CameraFit::refine(const CameraError& start, const FreeParts& free, std::size_t leave_out) const {
  CameraError error = start;
  for (int iteration = 0; iteration < kCameraFit.max_iterations; ++iteration) {
    std::vector<PairEquations> of_pair(near_.size());
    parallel_for(near_.size(), [&](std::size_t i) {
      const FlowPair& pair = pairs_.pairs[i];
      const auto here = compute_motion(pair, camera_from_lidar_, error);
      std::array<std::optional<Motion>, 4> there;
      for (int k = 0; k < 4; ++k)
        if (free[k]) there[k] = compute_motion(pair, camera_from_lidar_, error + get_step()[k] * Eigen::Vector4d::Unit(k));
      if (i == leave_out || !here) return;
      for (const Eigen::Vector3d& x : near_[i]) {
        const auto r = compute_residual(camera_, *here, pair.flow, x);
        if (!r) continue;
        Eigen::Matrix<double, 2, 4> J = Eigen::Matrix<double, 2, 4>::Zero();
        for (int k = 0; k < 4; ++k)
          if (const auto moved = there[k] ? compute_residual(camera_, *there[k], pair.flow, x) : std::nullopt)
            J.col(k) = (*moved - *r) / get_step()[k];
        const double weight = 1 / ((1 + r->squaredNorm()) * (1 + r->squaredNorm()));
        of_pair[i].A += weight * J.transpose() * J;
        of_pair[i].b -= weight * J.transpose() * *r;
      }
    });
    PairEquations all;
    for (const PairEquations& normal : of_pair) all.A += normal.A, all.b += normal.b;
    for (int k = 0; k < 4; ++k)
      if (!free[k]) all.A(k, k) = 1;
    const Eigen::Vector4d by = all.A.ldlt().solve(all.b);
    if (!by.allFinite()) break;
    error += by.cwiseMax(-get_max_change()).cwiseMin(get_max_change());
    if ((by.array().abs() < 0.01 * get_step().array()).all()) break;
  }
  return error;
}

double CameraFit::compute_visible_share() const {
  std::vector<double> shares;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const FlowPair& pair = pairs_.pairs[i];
    const auto motion = compute_motion(pair, camera_from_lidar_, CameraError::Zero());
    if (!motion) continue;
    const auto seen = std::count_if(pair.returns.begin(), pair.returns.end(), [&](const Eigen::Vector3d& x) {
      const Eigen::Vector3d x_in_camera = motion->from * x;
      return is_in_front(camera_, x_in_camera) && camera_.contains(camera_.project(x_in_camera));
    });
    shares.push_back(static_cast<double>(seen) / static_cast<double>(pair.returns.size()));
  }
  return median(std::move(shares));
}

}  // namespace dvi::diagnostics
