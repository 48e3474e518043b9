#include "dvi/harmonize/illumination_change.h"

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
#include "dvi/core/statistics.h"
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

/// Parameters of the comparison of illumination.
struct IlluminationParams {
  int max_surfaces = 4000;  ///< Surface points that are compared, at most.
  /// Distance of pixels from which normals are computed; at smaller ones noise of the depth dominates.
  int normal_step_px = 3;
  uchar box_px = 5;       ///< Side of the square whose mean color is compared, because positions have errors of about a pixel.
  int margin_px = 3;      ///< Distance to the mask: the extent of the box and of the camera's blur.
  float min_level = 8;    ///< Smallest channel of usable colors, in gray levels; noise dominates darker ones.
  float max_level = 250;  ///< Largest channel of usable colors, in gray levels; brighter ones are saturated.
  double depth_tolerance = 0.05;  ///< Relative difference of two depths of one surface.
  double min_cosine = 0.7071;     ///< Surfaces count for orientations within 45 degrees of their normal.
  float prior_surfaces = 10;      ///< Weight of an unchanged illumination.
  float min_surfaces = 20;        ///< Surfaces of an orientation below which it is not compared.
  /// Standard deviation of the logarithm of the color ratio above which an orientation is inconsistent: a factor of e. At half
  /// of it, changed facades would be rejected in some frames only, although they are better than interpolation.
  double max_sigma = 1;
  int block_px = 32;            ///< Surfaces are split into halves by image blocks of this size, because neighbors are similar.
  double bright_share = 0.999;  ///< Share of surfaces that are not brighter than IlluminationChange::max_surface_level.
};
constexpr IlluminationParams kIllumination;

/// The orientations: directions of the corners, edges, and faces of a cube.
constexpr std::size_t kDirections = 26;
using Directions = std::array<Eigen::Vector3d, kDirections>;
Directions list_directions() {
  Directions out;
  std::size_t count = 0;
  for (int k = 0; k < 27; ++k)
    if (const Eigen::Vector3i cell(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1); k != 13)
      out[count++] = cell.cast<double>().normalized();
  return out;
}

/// Computes the weight of a surface for each orientation.
std::array<float, kDirections> compute_weights(const Eigen::Vector3d& normal) {
  static const Directions all = list_directions();
  std::array<float, kDirections> out{};
  for (std::size_t k = 0; k < kDirections; ++k)
    out[k] =
        static_cast<float>(std::max(0.0, (all[k].dot(normal) - kIllumination.min_cosine) / (1 - kIllumination.min_cosine)));
  return out;
}

/// Returns the step of 1/z from a pixel to the next one of its surface: the smaller of those to both sides.
float select_step(float before, float here, float after) {
  if (before <= 0) return after > 0 ? after - here : 0;
  if (after <= 0) return here - before;
  return std::abs(here - before) < std::abs(after - here) ? here - before : after - here;
}

/// Computes the normal of the surface at a pixel, in camera axes, toward the camera; nothing if its depth is unknown.
std::optional<Eigen::Vector3d> compute_normal(cv::Point p, const Camera& camera, const depth::DepthMap& depth) {
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
  constexpr int kStep = kIllumination.normal_step_px;
  const Eigen::Vector3d right =
      point(p.x + kStep, p.y, select_step(inverse(p.x - kStep, p.y), here, inverse(p.x + kStep, p.y)));
  const Eigen::Vector3d below =
      point(p.x, p.y + kStep, select_step(inverse(p.x, p.y - kStep), here, inverse(p.x, p.y + kStep)));
  const Eigen::Vector3d normal = (right - at).cross(below - at).normalized();
  return normal.dot(at) > 0 ? -normal : normal;
}

/// A surface point of the target.
struct Surface {
  cv::Point pixel;
  Eigen::Vector3d at;  ///< Position in the axes of the target's camera.
  cv::Vec3f color;     ///< Color in the target's image.
  std::array<float, kDirections> weights{};
};

bool is_usable(const cv::Vec3f& color) {
  return std::min({color[0], color[1], color[2]}) >= kIllumination.min_level &&
         std::max({color[0], color[1], color[2]}) < kIllumination.max_level;
}

/// Measures IlluminationChange::max_surface_level on the unmasked surfaces.
float measure_max_level(const cv::Mat3b& image, const cv::Mat1b& masked, const depth::DepthMap& depth) {
  std::array<int, 256> count{};
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (const cv::Vec3b& c = image(y, x); masked(y, x) == 0 && depth::DepthMap::is_solid(depth.z(y, x)))
        ++count[std::max({c[0], c[1], c[2]})];
  const int all = std::accumulate(count.begin(), count.end(), 0);
  if (all < kIllumination.max_surfaces) return 255;
  std::size_t level = 0;
  for (int below = count[0]; below < kIllumination.bright_share * all; below += count[level]) ++level;
  return static_cast<float>(level);
}

/// Samples the unmasked surfaces of the target on a grid.
std::vector<Surface> sample_surfaces(const depth::Target& target) {
  constexpr int kMargin = kIllumination.margin_px;
  const depth::DepthMap& depth = target.depth;
  const auto image = target.image();
  const cv::Mat1b masked = grown(*target.mask(), kMargin);
  const Camera& camera = target.view().camera;
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(image->total()) / kIllumination.max_surfaces)));
  std::vector<Surface> out;
  for (int y = kMargin; y + kMargin < image->rows; y += step)
    for (int x = kMargin; x + kMargin < image->cols; x += step) {
      if (masked(y, x) != 0 || !depth::DepthMap::is_solid(depth.z(y, x))) continue;
      const cv::Vec3f color = box_mean(*image, cv::Point2f(cv::Point(x, y)), {kIllumination.box_px, kIllumination.box_px});
      const std::optional<Eigen::Vector3d> normal = compute_normal({x, y}, camera, depth);
      if (!normal || !is_usable(color)) continue;
      out.push_back({{x, y}, depth.z(y, x) * camera.ray({x, y}), color, compute_weights(*normal)});
    }
  return out;
}

/// Returns the image coordinates of a surface in a view; nothing if it is masked, occluded, or outside the image.
std::optional<cv::Point2f> project_surface(const Surface& surface, const Camera& camera, const SE3& source_from_target,
                                           const depth::VisibilityMap& visible) {
  const Eigen::Vector3d x = source_from_target * surface.at;
  if (!camera.in_front(x)) return std::nullopt;
  const Eigen::Vector2d p = camera.project(x);
  if (!camera.contains(p)) return std::nullopt;
  const cv::Point2f at = quantize(p.x(), p.y());
  if (!camera.contains({at.x, at.y}) || visible.clearance_px(at) < kIllumination.margin_px) return std::nullopt;
  constexpr double kTolerance = kIllumination.depth_tolerance;
  if (const double depth_m = camera.depth(x);
      visible.occludes(at, depth_m, kTolerance) || visible.is_farther(at, depth_m, kTolerance))
    return std::nullopt;
  return at;
}

/// A surface in two drives.
struct Comparison {
  const Surface* surface;
  cv::Vec3f log_ratio;  ///< Logarithm of the ratio of the target's color to that of the other drive.
};

/// Compares each surface with the first of the views that shows it.
std::vector<Comparison> compare_surfaces(const std::vector<Surface>& surfaces, const std::vector<int>& source_views,
                                         const depth::Target& target) {
  const Views& views = target.views;
  std::vector<Comparison> out;
  std::vector<char> done(surfaces.size(), 0);
  for (const int number : source_views) {
    const auto view = static_cast<std::size_t>(number);
    const Camera& camera = views[view].camera;
    const SE3 source_from_target = views[view].camera_from_world * target.view().camera_from_world.inverse();
    const cv::Vec3f gain = gain_to(target.view(), views[view]);
    const auto visible = target.visibility[view];
    const auto image = views.images[view];
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      if (done[i] != 0) continue;
      const std::optional<cv::Point2f> at = project_surface(surfaces[i], camera, source_from_target, *visible);
      if (!at) continue;
      const cv::Vec3f color = box_mean(*image, *at, {kIllumination.box_px, kIllumination.box_px});
      if (!is_usable(color)) continue;
      const float shade = vignetting_to(target.view(), surfaces[i].pixel, views[view], *at);
      cv::Vec3f log_ratio;
      for (int c = 0; c < 3; ++c) log_ratio[c] = std::log(surfaces[i].color[c] / (shade * color[c] * gain[c]));
      out.push_back({&surfaces[i], log_ratio});
      done[i] = 1;
    }
  }
  return out;
}

/// Computes the weighted median of values, reduced by the prior of an unchanged illumination; 0 if there are too few.
float compute_median(std::vector<std::pair<float, float>> value_weight) {
  std::sort(value_weight.begin(), value_weight.end());
  float all = 0;
  for (const auto& [value, weight] : value_weight) all += weight;
  if (all < kIllumination.min_surfaces) return 0;
  float before = 0;
  for (const auto& [value, weight] : value_weight) {
    before += weight;
    if (before >= all / 2) return value * all / (all + kIllumination.prior_surfaces);
  }
  return 0;
}

enum class Half : std::uint8_t { even, odd, both };

/// Selects the comparisons that count for an orientation, in one half of the image blocks or in both.
std::vector<Comparison> select_comparisons(const std::vector<Comparison>& compared, std::size_t direction, Half half) {
  std::vector<Comparison> out;
  for (const Comparison& k : compared) {
    const cv::Point block = k.surface->pixel / kIllumination.block_px;
    const bool chosen = half == Half::both || (block.x + block.y) % 2 == static_cast<int>(half);
    if (chosen && k.surface->weights[direction] > 0) out.push_back(k);
  }
  return out;
}

/// Fits the logarithm of the gain of an orientation.
cv::Vec3f fit_log_gain(const std::vector<Comparison>& compared, std::size_t direction) {
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    std::vector<std::pair<float, float>> values;
    for (const Comparison& k : compared) values.emplace_back(k.log_ratio[c], k.surface->weights[direction]);
    out[c] = compute_median(std::move(values));
  }
  return out;
}

/// Computes the mean absolute difference after the gain is applied.
double mean_residual(const std::vector<Comparison>& compared, std::size_t direction, const cv::Vec3f& log_gain) {
  double sum = 0, all = 0;
  for (const Comparison& k : compared) {
    const cv::Vec3f off = k.log_ratio - log_gain;
    sum += k.surface->weights[direction] * (std::abs(off[0]) + std::abs(off[1]) + std::abs(off[2])) / 3;
    all += k.surface->weights[direction];
  }
  return all > 0 ? sum / all : 0;
}

/// The change of illumination of surfaces with one orientation.
struct OrientationChange {
  cv::Vec3f log_gain;
  double sigma = 0;  ///< Standard deviation of the residuals.
};

OrientationChange estimate_change(const std::vector<Comparison>& compared, std::size_t direction) {
  const std::vector<Comparison> both = select_comparisons(compared, direction, Half::both);
  const std::vector<Comparison> even = select_comparisons(both, direction, Half::even);
  const std::vector<Comparison> odd = select_comparisons(both, direction, Half::odd);
  const auto improves = [&](const std::vector<Comparison>& fitted, const std::vector<Comparison>& held_out) {
    return mean_residual(held_out, direction, fit_log_gain(fitted, direction)) < mean_residual(held_out, direction, {});
  };
  OrientationChange out;
  if (improves(even, odd) && improves(odd, even)) out.log_gain = fit_log_gain(both, direction);
  if (static_cast<float>(both.size()) < kIllumination.min_surfaces) return out;
  std::vector<float> off;
  for (const Comparison& k : both)
    for (int c = 0; c < 3; ++c) off.push_back(std::abs(k.log_ratio[c] - out.log_gain[c]));
  out.sigma = estimate_sigma(std::move(off));
  return out;
}

/// Interpolates the gain of a surface between orientations; 1 if its normal is unknown, 0 if the orientations are inconsistent.
cv::Vec3f interpolate_gain(const std::optional<Eigen::Vector3d>& normal,
                           const std::array<OrientationChange, kDirections>& by_direction) {
  if (!normal) return {1, 1, 1};
  const std::array<float, kDirections> weights = compute_weights(*normal);
  float all = 0;
  double sigma = 0;
  cv::Vec3f log_gain;
  for (std::size_t k = 0; k < kDirections; ++k) {
    all += weights[k];
    log_gain += weights[k] * by_direction[k].log_gain;
    sigma += weights[k] * by_direction[k].sigma;
  }
  if (all <= 0) return {1, 1, 1};
  if (sigma / all > kIllumination.max_sigma) return {};
  return {std::exp(log_gain[0] / all), std::exp(log_gain[1] / all), std::exp(log_gain[2] / all)};
}

}  // namespace

IlluminationChange compare_illumination(const depth::Target& target, const sample::Candidates& candidates) {
  const Views& views = target.views;
  IlluminationChange out;
  std::map<int, std::map<int, int>> used;  // number of candidates by drive and view
  for (const sample::Candidate& c : candidates.leading)
    if (c.found() && views[c.view].drive != target.view().drive) ++used[views[c.view].drive][c.view];
  if (used.empty()) return out;
  const std::vector<Surface> surfaces = sample_surfaces(target);
  out.max_surface_level = measure_max_level(*target.image(), *target.mask(), target.depth);
  std::vector<std::optional<Eigen::Vector3d>> normals;
  for (const cv::Point p : candidates.hole.pixels) normals.push_back(compute_normal(p, target.view().camera, target.depth));
  for (const auto& [drive, counts] : used) {
    std::vector<int> source_views;
    for (const auto& [view, count] : counts) source_views.push_back(view);
    std::stable_sort(source_views.begin(), source_views.end(), [&](int a, int b) { return counts.at(a) > counts.at(b); });
    const std::vector<Comparison> compared = compare_surfaces(surfaces, source_views, target);
    std::array<OrientationChange, kDirections> by_direction;
    for (std::size_t k = 0; k < kDirections; ++k) by_direction[k] = estimate_change(compared, k);
    out.drives.resize(std::max(out.drives.size(), static_cast<std::size_t>(drive) + 1));
    std::vector<cv::Vec3f>& gain = out.drives[static_cast<std::size_t>(drive)].gain;
    for (const std::optional<Eigen::Vector3d>& normal : normals) gain.push_back(interpolate_gain(normal, by_direction));
  }
  return out;
}

}  // namespace dvi::harmonize
