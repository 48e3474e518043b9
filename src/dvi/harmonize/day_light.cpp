#include "dvi/harmonize/day_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "dvi/core/lazy.h"
#include "dvi/core/median.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"
#include "dvi/drive/vignetting.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

constexpr int kSurfaces = 4000;      // compared, at most
constexpr int kStep = 3;             // px from which the direction of a surface is told: depths are noisy
constexpr uchar kBox = 5;            // px, the square whose mean color is compared: copies are off by a pixel or so
constexpr int kMargin = 3;           // px round the mask that the box and the camera's blur reach
constexpr float kTooDark = 8;        // gray levels; darker, noise outweighs the light
constexpr float kTooBright = 250;    // gray levels
constexpr double kTolerance = 0.05;  // part of the depth by which two depths of one surface differ
constexpr double kReach = 0.7071;    // cosine of the angle to which a direction counts, 45 degrees: the next one
constexpr float kFew = 10;           // surfaces that weigh as much as "the light is the same"
constexpr float kFewest = 20;        // surfaces of a direction
// One sigma of the ratio's logarithm from which on a copy tells nothing: off by a factor of e. Half of it would refuse changed
// fronts too, in some frames and not in others, although even these are nearer to the truth than what is interpolated.
constexpr double kUnlike = 1;
constexpr int kSquare = 32;  // px: neighbors show the same, so the halves that check each other are squares of the image
constexpr double kBrightest = 0.999;  // part of the surfaces that are no brighter

/// The directions in which the corners, edges and faces of a cube lie.
constexpr std::size_t kDirections = 26;
using Directions = std::array<Eigen::Vector3d, kDirections>;
Directions directions() {
  Directions out;
  std::size_t count = 0;
  for (int k = 0; k < 27; ++k)
    if (const Eigen::Vector3i cell(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1); k != 13)
      out[count++] = cell.cast<double>().normalized();
  return out;
}

/// How much a surface tells of each direction.
std::array<float, kDirections> weights_of(const Eigen::Vector3d& normal) {
  static const Directions all = directions();
  std::array<float, kDirections> out{};
  for (std::size_t k = 0; k < kDirections; ++k)
    out[k] = static_cast<float>(std::max(0.0, (all[k].dot(normal) - kReach) / (1 - kReach)));
  return out;
}

/// The step of 1/z away from a pixel of the same surface: the smaller of those to both sides.
float step(float before, float here, float after) {
  if (before <= 0) return after > 0 ? after - here : 0;
  if (after <= 0) return here - before;
  return std::abs(here - before) < std::abs(after - here) ? here - before : after - here;
}

/// The direction that the surface at a pixel faces, in the axes of the camera; none where its depth is unknown.
std::optional<Eigen::Vector3d> normal_at(cv::Point p, const Camera& camera, const depth::DepthMap& depth) {
  const auto inverse = [&](int x, int y) {
    const bool inside = x >= 0 && y >= 0 && x < depth.z.cols && y < depth.z.rows;
    return inside && depth::DepthMap::is_solid(depth.z(y, x)) ? 1 / depth.z(y, x) : 0.0F;
  };
  const float here = inverse(p.x, p.y);
  if (here <= 0) return std::nullopt;
  const auto point = [&](int x, int y, float by) -> Eigen::Vector3d {
    return camera.ray({x, y}) / std::max(here + by, 0.5F * here);
  };
  const Eigen::Vector3d at = point(p.x, p.y, 0);
  const Eigen::Vector3d right = point(p.x + kStep, p.y, step(inverse(p.x - kStep, p.y), here, inverse(p.x + kStep, p.y)));
  const Eigen::Vector3d below = point(p.x, p.y + kStep, step(inverse(p.x, p.y - kStep), here, inverse(p.x, p.y + kStep)));
  const Eigen::Vector3d normal = (right - at).cross(below - at).normalized();
  return normal.dot(at) > 0 ? -normal : normal;
}

/// A surface beside the hole.
struct Surface {
  cv::Point pixel;
  Eigen::Vector3d at;  ///< in the axes of the target's camera
  cv::Vec3f color;     ///< in the target's image
  std::array<float, kDirections> weights{};
};

bool usable(const cv::Vec3f& color) {
  return std::min({color[0], color[1], color[2]}) >= kTooDark && std::max({color[0], color[1], color[2]}) < kTooBright;
}

/// Of the unmasked surfaces, where they are brightest.
float brightest(const cv::Mat3b& image, const cv::Mat1b& masked, const depth::DepthMap& depth) {
  std::array<int, 256> count{};
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (const cv::Vec3b& c = image(y, x); masked(y, x) == 0 && depth::DepthMap::is_solid(depth.z(y, x)))
        ++count[std::max({c[0], c[1], c[2]})];
  const int all = std::accumulate(count.begin(), count.end(), 0);
  if (all < kSurfaces) return 255;
  std::size_t level = 0;
  for (int below = count[0]; below < kBrightest * all; below += count[level]) ++level;
  return static_cast<float>(level);
}

std::vector<Surface> surfaces_beside(const depth::Target& target) {
  const depth::DepthMap& depth = target.depth;
  const auto image = target.image();
  const cv::Mat1b masked = grown(*target.mask(), kMargin);
  const Camera& camera = target.view().camera;
  const int apart = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(image->total()) / kSurfaces)));
  std::vector<Surface> out;
  for (int y = kMargin; y + kMargin < image->rows; y += apart)
    for (int x = kMargin; x + kMargin < image->cols; x += apart) {
      if (masked(y, x) != 0 || !depth::DepthMap::is_solid(depth.z(y, x))) continue;
      const cv::Vec3f color = box_mean(*image, cv::Point2f(cv::Point(x, y)), {kBox, kBox});
      const std::optional<Eigen::Vector3d> normal = normal_at({x, y}, camera, depth);
      if (!normal || !usable(color)) continue;
      out.push_back({{x, y}, depth.z(y, x) * camera.ray({x, y}), color, weights_of(*normal)});
    }
  return out;
}

/// Where a view shows it, unmasked and unhidden.
std::optional<cv::Point2f> shown_at(const Surface& surface, const Camera& camera, const SE3& source_from_target,
                                    const depth::VisibilityMap& seen) {
  const Eigen::Vector3d x = source_from_target * surface.at;
  if (!camera.in_front(x)) return std::nullopt;
  const Eigen::Vector2d p = camera.project(x);
  if (!camera.contains(p)) return std::nullopt;
  const cv::Point2f at = quantized(p.x(), p.y());
  if (!camera.contains({at.x, at.y}) || seen.clearance_px(at) < kMargin) return std::nullopt;
  if (seen.occludes(at, x.z(), kTolerance) || seen.is_farther(at, x.z(), kTolerance)) return std::nullopt;
  return at;
}

/// What two days give one surface.
struct Comparison {
  const Surface* surface;
  cv::Vec3f ratio;  ///< logarithm, of the target's color to the other's
};

/// Each surface as the first of these views shows it.
std::vector<Comparison> compare(const std::vector<Surface>& surfaces, const std::vector<int>& of_drive,
                                const depth::Target& target) {
  const Views& views = target.views;
  std::vector<Comparison> out;
  std::vector<char> done(surfaces.size(), 0);
  for (const int number : of_drive) {
    const auto view = static_cast<std::size_t>(number);
    const Camera& camera = views[view].camera;
    const SE3 source_from_target = views[view].camera_from_world * target.view().camera_from_world.inverse();
    const cv::Vec3f gain = gain_to(target.view(), views[view]);
    const auto seen = target.visibility[view];
    const auto image = views.images[view];
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      if (done[i] != 0) continue;
      const std::optional<cv::Point2f> at = shown_at(surfaces[i], camera, source_from_target, *seen);
      if (!at) continue;
      const cv::Vec3f color = box_mean(*image, *at, {kBox, kBox});
      if (!usable(color)) continue;
      const float shade = vignetting_to(target.view(), surfaces[i].pixel, views[view], *at);
      cv::Vec3f ratio;
      for (int c = 0; c < 3; ++c) ratio[c] = std::log(surfaces[i].color[c] / (shade * color[c] * gain[c]));
      out.push_back({&surfaces[i], ratio});
      done[i] = 1;
    }
  }
  return out;
}

/// The median of values by weight, drawn to 0 by kFew; 0 of too few.
float weighted_median(std::vector<std::pair<float, float>> value_weight) {
  std::sort(value_weight.begin(), value_weight.end());
  float all = 0;
  for (const auto& [value, weight] : value_weight) all += weight;
  if (all < kFewest) return 0;
  float before = 0;
  for (const auto& [value, weight] : value_weight) {
    before += weight;
    if (before >= all / 2) return value * all / (all + kFew);
  }
  return 0;
}

/// Those that tell of one direction.
enum class Half : std::uint8_t { even, odd, both };
std::vector<Comparison> of_direction(const std::vector<Comparison>& compared, std::size_t direction, Half half) {
  std::vector<Comparison> out;
  for (const Comparison& k : compared) {
    const cv::Point square = k.surface->pixel / kSquare;
    const bool chosen = half == Half::both || (square.x + square.y) % 2 == static_cast<int>(half);
    if (chosen && k.surface->weights[direction] > 0) out.push_back(k);
  }
  return out;
}

cv::Vec3f fit(const std::vector<Comparison>& compared, std::size_t direction) {
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<float, float>> values;
    for (const Comparison& k : compared) values.emplace_back(k.ratio[c], k.surface->weights[direction]);
    out[c] = weighted_median(std::move(values));
  }
  return out;
}

/// The mean by which they differ once the gain is applied.
double difference(const std::vector<Comparison>& compared, std::size_t direction, const cv::Vec3f& log_gain) {
  double sum = 0, all = 0;
  for (const Comparison& k : compared) {
    const cv::Vec3f off = k.ratio - log_gain;
    sum += k.surface->weights[direction] * (std::abs(off[0]) + std::abs(off[1]) + std::abs(off[2])) / 3;
    all += k.surface->weights[direction];
  }
  return all > 0 ? sum / all : 0;
}

/// What is known of the surfaces that face one way.
struct Facing {
  cv::Vec3f log_gain;
  double unlike = 0;  ///< one sigma of what the gain leaves
};

Facing facing(const std::vector<Comparison>& compared, std::size_t direction) {
  const std::vector<Comparison> both = of_direction(compared, direction, Half::both);
  const std::vector<Comparison> even = of_direction(both, direction, Half::even);
  const std::vector<Comparison> odd = of_direction(both, direction, Half::odd);
  const auto improves = [&](const std::vector<Comparison>& fitted, const std::vector<Comparison>& held_out) {
    return difference(held_out, direction, fit(fitted, direction)) < difference(held_out, direction, {});
  };
  Facing out;
  if (improves(even, odd) && improves(odd, even)) out.log_gain = fit(both, direction);
  if (static_cast<float>(both.size()) < kFewest) return out;
  std::vector<float> off;
  for (const Comparison& k : both)
    for (int c = 0; c < 3; ++c) off.push_back(std::abs(k.ratio[c] - out.log_gain[c]));
  out.unlike = 1.4826 * median(std::move(off));
  return out;
}

/// By the directions nearest to the surface's.
cv::Vec3f gain_of(const std::optional<Eigen::Vector3d>& normal, const std::array<Facing, kDirections>& by_direction) {
  if (!normal) return {1, 1, 1};
  const std::array<float, kDirections> weights = weights_of(*normal);
  float all = 0;
  double unlike = 0;
  cv::Vec3f log_gain;
  for (std::size_t k = 0; k < kDirections; ++k) {
    all += weights[k];
    log_gain += weights[k] * by_direction[k].log_gain;
    unlike += weights[k] * by_direction[k].unlike;
  }
  if (all <= 0) return {1, 1, 1};
  if (unlike / all > kUnlike) return {};
  return {std::exp(log_gain[0] / all), std::exp(log_gain[1] / all), std::exp(log_gain[2] / all)};
}

}  // namespace

DayLight compare_days(const depth::Target& target, const sample::Candidates& candidates) {
  const Views& views = target.views;
  DayLight out;
  std::map<int, std::map<int, int>> used;  // by drive, how often each view
  for (const sample::Candidate& c : candidates.leading)
    if (c.found() && views[c.view].drive != target.view().drive) ++used[views[c.view].drive][c.view];
  if (used.empty()) return out;
  const std::vector<Surface> surfaces = surfaces_beside(target);
  out.brightest = brightest(*target.image(), *target.mask(), target.depth);
  std::vector<std::optional<Eigen::Vector3d>> normals;
  for (const cv::Point p : candidates.hole.pixels) normals.push_back(normal_at(p, target.view().camera, target.depth));
  for (const auto& [drive, counts] : used) {
    std::vector<int> of_drive;
    for (const auto& [view, count] : counts) of_drive.push_back(view);
    std::stable_sort(of_drive.begin(), of_drive.end(), [&](int a, int b) { return counts.at(a) > counts.at(b); });
    const std::vector<Comparison> compared = compare(surfaces, of_drive, target);
    std::array<Facing, kDirections> by_direction;
    for (std::size_t k = 0; k < kDirections; ++k) by_direction[k] = facing(compared, k);
    out.drives.resize(std::max(out.drives.size(), static_cast<std::size_t>(drive) + 1));
    std::vector<cv::Vec3f>& gain = out.drives[static_cast<std::size_t>(drive)].gain;
    for (const std::optional<Eigen::Vector3d>& normal : normals) gain.push_back(gain_of(normal, by_direction));
  }
  return out;
}

}  // namespace dvi::harmonize
