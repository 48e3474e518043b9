#include "dvi/sample/sighting.h"

#include <algorithm>
#include <cmath>

namespace dvi::sample {
namespace {

constexpr double kShift = 0.3;  // px: from here on a copy suffers from being off more than from the camera's own blur
constexpr double kDrift = 0.3;  // px of shift between frames a second apart; a random walk, so it grows with the root

double squared(double x) { return x * x; }

/// The step of 1/z to the next pixel of the same surface: the smaller of those to both sides, as one may lead over an edge.
float step(float before, float here, float after) {
  const float back = here - before, forth = after - here;
  return std::abs(back) < std::abs(forth) ? back : forth;
}

double shift_squared(const SourceFootprint& sighting, double seconds) {
  return squared(sighting.misplaced) + squared(kDrift) * seconds;
}

double error_squared(const SourceFootprint& sighting, double seconds) {
  const double blur = 0.5 * std::max(0.0, 1 / std::max(sighting.smallest, 1e-3) - 1);
  return shift_squared(sighting, seconds) + squared(blur);
}

}  // namespace

std::vector<SurfacePixel> surface_pixels(const Region& hole, const Camera& camera, const depth::DepthMap& depth) {
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
    const auto stepped = [&](float by) { return 1 / std::max(here + by, 0.5F * here); };
    const float right = stepped(step(inverse(x - 1, y), here, inverse(x + 1, y)));
    const float below = stepped(step(inverse(x, y - 1), here, inverse(x, y + 1)));
    const Eigen::Vector3d at = z * camera.ray({x, y});
    const double sigma = depth.sigma(y, x);
    out.push_back({i, at, right * camera.ray({x + 1, y}), below * camera.ray({x, y + 1}), at * (1 + sigma / at.z()), sigma});
  }
  return out;
}

std::optional<SourcePosition> locate(const SurfacePixel& pixel, const Camera& source, const SE3& source_from_target) {
  const Eigen::Vector3d x = source_from_target * pixel.at;
  if (!source.in_front(x)) return std::nullopt;
  const SourcePosition out{source.project(x), x.z()};
  return source.contains(out.position) ? std::optional(out) : std::nullopt;
}

std::optional<SourceFootprint> sight(const SurfacePixel& pixel, const SourcePosition& place, const Camera& source,
                                     const SE3& source_from_target) {
  const Eigen::Vector3d deeper = source_from_target * pixel.deeper;
  if (!source.in_front(deeper)) return std::nullopt;
  SourceFootprint out;
  Eigen::Matrix2d spans;
  spans.col(0) = source.project(source_from_target * pixel.right) - place.position;
  spans.col(1) = source.project(source_from_target * pixel.below) - place.position;
  out.across = spans.row(0).norm();
  out.down = spans.row(1).norm();
  // The smaller singular value, from the sum and the product of both, squared.
  const double sum = spans.squaredNorm(), product = squared(spans.determinant());
  out.smallest = std::sqrt(0.5 * std::max(0.0, sum - std::sqrt(std::max(0.0, sum * sum - 4 * product))));
  out.misplaced = (source.project(deeper) - place.position).norm() / std::max(1e-3, std::sqrt(0.5 * sum));
  return out;
}

double expected_shift(const SourceFootprint& sighting, double seconds) { return std::sqrt(shift_squared(sighting, seconds)); }

double expected_error(const SourceFootprint& sighting, double seconds) { return std::sqrt(error_squared(sighting, seconds)); }

double trust(const SourceFootprint& sighting, double seconds, double clear_px) {
  const double clear = clear_px + 0.5;
  return clear / (clear + 1) / (1 + error_squared(sighting, seconds) / squared(kShift));
}

double most_trust(double seconds) { return 1 / (1 + squared(kDrift) * seconds / squared(kShift)); }

// In the order of trust(), so that rounding does not take it below.
double most_trust(double seconds, double clear_px) {
  const double clear = clear_px + 0.5;
  return clear / (clear + 1) / (1 + squared(kDrift) * seconds / squared(kShift));
}

}  // namespace dvi::sample
