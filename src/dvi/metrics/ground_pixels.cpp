#include "dvi/metrics/ground_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Dense>

#include "dvi/core/random.h"

namespace dvi::metrics {
namespace {

struct GroundPlaneParams {
  int grid_step_px = 12;         // distance of the samples, which are in the lower half of the image
  int draws = 100;               // planes through three random samples
  double tolerance = 0.06;       // relative error of the inverse depth of samples on the plane
  std::size_t min_samples = 30;  // on the plane
  double min_share = 0.2;        // samples on the plane
  int refinements = 3;
  double highest_horizon = -0.5;  // row of the plane's horizon in the middle of the image, as a share of its height
  double max_height = 0.2;        // above the plane, of the camera's height
};
constexpr GroundPlaneParams kPlane;

// The inverse depth of a pixel with the coordinates (1, x, y), as shares of the image.
struct InverseDepth {
  Eigen::Vector3d coordinates;
  double value;
};

Eigen::Vector3d to_coordinates(int x, int y, cv::Size size) {
  return {1, static_cast<double>(x) / size.width, static_cast<double>(y) / size.height};
}

std::vector<InverseDepth> sample(const cv::Mat1w& depth) {
  std::vector<InverseDepth> samples;
  for (int y = depth.rows / 2; y < depth.rows; y += kPlane.grid_step_px)
    for (int x = 0; x < depth.cols; x += kPlane.grid_step_px)
      if (depth(y, x) > 0) samples.push_back({to_coordinates(x, y, depth.size()), 256.0 / depth(y, x)});
  return samples;
}

bool is_on(const Eigen::Vector3d& plane, const InverseDepth& sample) {
  return std::abs(plane.dot(sample.coordinates) - sample.value) < kPlane.tolerance * sample.value;
}

std::size_t count_on(const Eigen::Vector3d& plane, const std::vector<InverseDepth>& samples) {
  return static_cast<std::size_t>(
      std::count_if(samples.begin(), samples.end(), [&](const InverseDepth& s) { return is_on(plane, s); }));
}

// Whether a plane may be the ground: the inverse depth increases downward from 0 at the horizon.
bool may_be_ground(const Eigen::Vector3d& plane) {
  const double at_top = plane.x() + 0.5 * plane.y();
  return plane.z() > 0 && -at_top > kPlane.highest_horizon * plane.z() && -at_top < plane.z();
}

// Returns the plane through three samples with the most samples on it; 0 if none may be the ground.
Eigen::Vector3d find_plane(const std::vector<InverseDepth>& samples) {
  Random random(1);
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  std::size_t most = 0;
  for (int draw = 0; draw < kPlane.draws; ++draw) {
    Eigen::Matrix3d A;
    Eigen::Vector3d b;
    for (int row = 0; row < 3; ++row) {
      const InverseDepth& s = samples[static_cast<std::size_t>(random.below(static_cast<int>(samples.size())))];
      A.row(row) = s.coordinates;
      b(row) = s.value;
    }
    if (std::abs(A.determinant()) < 1e-6) continue;
    const Eigen::Vector3d plane = A.inverse() * b;
    if (!may_be_ground(plane)) continue;
    if (const std::size_t count = count_on(plane, samples); count > most) best = plane, most = count;
  }
  return best;
}

// Fits the plane to the samples on it, with the same weight for each relative error.
Eigen::Vector3d refine(Eigen::Vector3d plane, const std::vector<InverseDepth>& samples) {
  for (int i = 0; i < kPlane.refinements; ++i) {
    Eigen::Matrix3d A = 1e-12 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const InverseDepth& s : samples) {
      if (!is_on(plane, s)) continue;
      const Eigen::Vector3d row = s.coordinates / s.value;
      A += row * row.transpose();
      b += row;
    }
    plane = A.ldlt().solve(b);
  }
  return plane;
}

}  // namespace

cv::Mat1b find_ground_pixels(const cv::Mat1w& depth) {
  const std::vector<InverseDepth> samples = sample(depth);
  if (samples.size() < kPlane.min_samples) return {};
  const Eigen::Vector3d plane = refine(find_plane(samples), samples);
  const std::size_t on = count_on(plane, samples);
  if (!may_be_ground(plane) || on < kPlane.min_samples ||
      static_cast<double>(on) < kPlane.min_share * static_cast<double>(samples.size()))
    return {};
  cv::Mat1b ground(depth.size(), uchar{0});
  const double step = plane.y() / depth.cols;
  for (int y = 0; y < depth.rows; ++y) {
    const double first = plane.dot(to_coordinates(0, y, depth.size()));
    // With the camera at height 1, a point is at height 1 - (inverse depth of the plane) / (inverse depth of the point).
    for (int x = 0; x < depth.cols; ++x)
      if ((first + step * x) * depth(y, x) > (1 - kPlane.max_height) * 256.0) ground(y, x) = 255;
  }
  return ground;
}

}  // namespace dvi::metrics
