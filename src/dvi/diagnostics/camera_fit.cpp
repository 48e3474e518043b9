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

constexpr double kNearest = 0.1;                     // meters along the optical axis
constexpr std::size_t kMostReturns = 1500;           // returns of a pair
constexpr std::size_t kFewestReturns = 100;          // of them with flow, else the pair tells nothing
constexpr double kBorder = 0.2;                      // image widths round the image: what rotations may bring into it
constexpr double kSlackPx = 0.5, kSlackShare = 0.1;  // error of flow, and share of the flow that depth may be wrong by
constexpr int kIterations = 25;

const Eigen::Vector4d& step() {  // of the numeric derivatives: about a pixel
  static const Eigen::Vector4d value(0.002, 0.002, 0.002, 0.01);
  return value;
}
const Eigen::Vector4d& longest() {  // of an iteration
  static const Eigen::Vector4d value(0.03, 0.03, 0.03, 0.1);
  return value;
}

/// camera_from_world at two images.
struct Motion {
  SE3 from, to;
};

std::optional<Motion> motion_of(const FlowPair& pair, const SE3& camera_from_lidar, const CameraError& error) {
  const auto late_ns = static_cast<std::int64_t>(std::llround(1e9 * error[3]));
  const auto from = pair.world_from_lidar.at(pair.from_ns - late_ns), to = pair.world_from_lidar.at(pair.to_ns - late_ns);
  if (!from || !to) return std::nullopt;
  const SE3 turned = SE3{so3_exp(error.head<3>()), Eigen::Vector3d::Zero()} * camera_from_lidar;
  return Motion{turned * from->inverse(), turned * to->inverse()};
}

bool in_front(const Camera& camera, const Eigen::Vector3d& x_in_camera) {
  return x_in_camera.z() > kNearest && camera.in_front(x_in_camera);
}

/// Observed less predicted flow at a return, in units of its slack; none where the flow is not known.
std::optional<Eigen::Vector2d> residual(const Camera& camera, const Motion& motion, const cv::Mat2f& flow,
                                        const Eigen::Vector3d& x) {
  const Eigen::Vector3d a = motion.from * x, b = motion.to * x;
  if (!in_front(camera, a) || !in_front(camera, b)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(a);
  if (!camera.contains(pixel)) return std::nullopt;
  const cv::Vec2f& seen = flow(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
  if (std::isnan(seen[0])) return std::nullopt;
  const Eigen::Vector2d observed(seen[0], seen[1]);
  return (observed - (camera.project(b) - pixel)) / (kSlackPx + kSlackShare * observed.norm());
}

/// Of one pair; parts that are not free stay zero.
struct Normal {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
};

}  // namespace

CameraFit::CameraFit(const FlowPairs& pairs, const Camera& camera, const SE3& camera_from_lidar)
    : pairs_(pairs), camera_(camera), camera_from_lidar_(camera_from_lidar), near_(pairs.pairs.size()) {
  const double border = kBorder * camera.width;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const auto motion = motion_of(pairs.pairs[i], camera_from_lidar, CameraError::Zero());
    if (!motion) continue;
    std::vector<Eigen::Vector3d> all;
    for (const Eigen::Vector3d& x : pairs.pairs[i].returns) {
      const Eigen::Vector3d x_in_camera = motion->from * x;
      if (!in_front(camera, x_in_camera)) continue;
      const Eigen::Vector2d p = camera.project(x_in_camera);
      if (p.x() > -border && p.y() > -border && p.x() < camera.width + border && p.y() < camera.height + border)
        all.push_back(x);
    }
    const std::size_t every = all.size() / kMostReturns + 1;
    for (std::size_t k = 0; k < all.size(); k += every) near_[i].push_back(all[k]);
  }
}

std::vector<double> CameraFit::costs(const CameraError& error) const {
  std::vector<double> out(near_.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(near_.size(), [&](std::size_t i) {
    const FlowPair& pair = pairs_.pairs[i];
    const auto motion = motion_of(pair, camera_from_lidar_, error);
    if (!motion) return;
    double sum = 0;
    std::size_t n = 0;
    for (const Eigen::Vector3d& x : near_[i]) {
      const auto r = residual(camera_, *motion, pair.flow, x);
      if (!r) continue;
      sum += r->squaredNorm() / (1 + r->squaredNorm());
      ++n;
    }
    out[i] = n >= kFewestReturns ? sum / static_cast<double>(n) : 1;
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

CameraError CameraFit::refined(const CameraError& start, const FreeParts& free, std::size_t leave_out) const {
  CameraError error = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<Normal> of_pair(near_.size());
    parallel_for(near_.size(), [&](std::size_t i) {
      const FlowPair& pair = pairs_.pairs[i];
      const auto here = motion_of(pair, camera_from_lidar_, error);
      std::array<std::optional<Motion>, 4> there;
      for (int k = 0; k < 4; ++k)
        if (free[k]) there[k] = motion_of(pair, camera_from_lidar_, error + step()[k] * Eigen::Vector4d::Unit(k));
      if (i == leave_out || !here) return;
      for (const Eigen::Vector3d& x : near_[i]) {
        const auto r = residual(camera_, *here, pair.flow, x);
        if (!r) continue;
        Eigen::Matrix<double, 2, 4> J = Eigen::Matrix<double, 2, 4>::Zero();
        for (int k = 0; k < 4; ++k)
          if (const auto moved = there[k] ? residual(camera_, *there[k], pair.flow, x) : std::nullopt)
            J.col(k) = (*moved - *r) / step()[k];
        const double weight = 1 / ((1 + r->squaredNorm()) * (1 + r->squaredNorm()));
        of_pair[i].A += weight * J.transpose() * J;
        of_pair[i].b -= weight * J.transpose() * *r;
      }
    });
    Normal all;
    for (const Normal& normal : of_pair) all.A += normal.A, all.b += normal.b;
    for (int k = 0; k < 4; ++k)
      if (!free[k]) all.A(k, k) = 1;
    const Eigen::Vector4d by = all.A.ldlt().solve(all.b);
    if (!by.allFinite()) break;
    error += by.cwiseMax(-longest()).cwiseMin(longest());
    if ((by.array().abs() < 0.01 * step().array()).all()) break;
  }
  return error;
}

double CameraFit::share_in_sight() const {
  std::vector<double> shares;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const FlowPair& pair = pairs_.pairs[i];
    const auto motion = motion_of(pair, camera_from_lidar_, CameraError::Zero());
    if (!motion) continue;
    const auto seen = std::count_if(pair.returns.begin(), pair.returns.end(), [&](const Eigen::Vector3d& x) {
      const Eigen::Vector3d x_in_camera = motion->from * x;
      return in_front(camera_, x_in_camera) && camera_.contains(camera_.project(x_in_camera));
    });
    shares.push_back(static_cast<double>(seen) / static_cast<double>(pair.returns.size()));
  }
  return median(std::move(shares));
}

}  // namespace dvi::diagnostics
