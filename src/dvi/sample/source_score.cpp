#include "dvi/sample/source_score.h"

#include <algorithm>
#include <cmath>

namespace dvi::sample {
namespace {

double square(double x) { return x * x; }

/// Returns the step of 1/z to the next pixel of the same surface: the smaller one of both sides, because one may cross an edge.
float select_step(float before, float here, float after) {
  const float back = here - before, forth = after - here;
  return std::abs(back) < std::abs(forth) ? back : forth;
}

double squared_position_error(const SourceFootprint& footprint, double seconds) {
  return square(footprint.depth_error_px) + square(kSourceScore.drift_px) * seconds;
}

double squared_error(const SourceFootprint& footprint, double seconds) {
  const double blur = 0.5 * std::max(0.0, 1 / std::max(footprint.smallest, 1e-3) - 1);
  return squared_position_error(footprint, seconds) + square(blur);
}

}  // namespace

std::vector<SurfacePixel> find_surface_pixels(const Region& hole, const Camera& camera, const depth::DepthMap& depth) {
  const auto inverse = [&](int x, int y) {
    const float z = depth.z(std::clamp(y, 0, depth.z.rows - 1), std::clamp(x, 0, depth.z.cols - 1));
    return depth::DepthMap::is_surface(z) ? 1 / z : 0.0F;
  };
  std::vector<SurfacePixel> out;
  out.reserve(hole.size());
  for (std::size_t i = 0; i < hole.size(); ++i) {
    const auto [x, y] = hole.pixels[i];
    const float z = depth.z(y, x);
    if (!depth::DepthMap::is_surface(z)) continue;
    const float here = 1 / z;
    const auto depth_after = [&](float step) { return 1 / std::max(here + step, 0.5F * here); };
    const float right = depth_after(select_step(inverse(x - 1, y), here, inverse(x + 1, y)));
    const float below = depth_after(select_step(inverse(x, y - 1), here, inverse(x, y + 1)));
    const Eigen::Vector3d at = z * camera.ray({x, y});
    const double sigma = depth.sigma(y, x);
    out.push_back({i, at, right * camera.ray({x + 1, y}), below * camera.ray({x, y + 1}), at * (1 + sigma / z), sigma, z});
  }
  return out;
}

std::optional<SourcePosition> locate(const SurfacePixel& pixel, const Camera& source, const SE3& source_from_target) {
  const Eigen::Vector3d x = source_from_target * pixel.at;
  if (!source.in_front(x)) return std::nullopt;
  const SourcePosition out{source.project(x), source.depth(x)};
  return source.contains(out.position) ? std::optional(out) : std::nullopt;
}

std::optional<SourceFootprint> measure_footprint(const SurfacePixel& pixel, const SourcePosition& place, const Camera& source,
                                                 const SE3& source_from_target) {
  const Eigen::Vector3d deeper = source_from_target * pixel.deeper;
  if (!source.in_front(deeper)) return std::nullopt;
  SourceFootprint out;
  Eigen::Matrix2d spans;
  spans.col(0) = source.project(source_from_target * pixel.right) - place.position;
  spans.col(1) = source.project(source_from_target * pixel.below) - place.position;
  out.across = spans.row(0).norm();
  out.down = spans.row(1).norm();
  // The smaller singular value, from the sum and the product of both squared singular values.
  const double sum = spans.squaredNorm(), product = square(spans.determinant());
  out.smallest = std::sqrt(0.5 * std::max(0.0, sum - std::sqrt(std::max(0.0, sum * sum - 4 * product))));
  out.depth_error_px = (source.project(deeper) - place.position).norm() / std::max(1e-3, std::sqrt(0.5 * sum));
  return out;
}

double estimate_position_error_px(const SourceFootprint& footprint, double seconds) {
  return std::sqrt(squared_position_error(footprint, seconds));
}

double estimate_copy_error_px(const SourceFootprint& footprint, double seconds) {
  return std::sqrt(squared_error(footprint, seconds));
}

double score_source(const SourceFootprint& footprint, double seconds, double clearance_px) {
  const double clear = clearance_px + 0.5;
  return clear / (clear + 1) / (1 + squared_error(footprint, seconds) / square(kSourceScore.tolerance_px));
}

double max_score(double seconds) {
  return 1 / (1 + square(kSourceScore.drift_px) * seconds / square(kSourceScore.tolerance_px));
}

// It computes in the same order as score_source(), so that rounding does not make it smaller.
double max_score(double seconds, double clearance_px) {
  const double clear = clearance_px + 0.5;
  return clear / (clear + 1) / (1 + square(kSourceScore.drift_px) * seconds / square(kSourceScore.tolerance_px));
}

}  // namespace dvi::sample
