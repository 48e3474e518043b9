#include "dvi/objects/background_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/saturation.h"

namespace dvi::objects {
namespace {

struct BackgroundParams {
  double max_ground_distance_m = 60;    ///< beyond, a pixel covers meters of ground
  double first_ground_distance_m = 10;  ///< the height of the ground at this distance is the initial guess of the intersection
  int max_ground_iterations = 6;        ///< the intersection converges in fewer, except at edges of the ground
  double ground_tolerance_m = 1e-3;     ///< step at which the intersection has converged
  std::size_t min_gain_samples = 20;    ///< pixels that both views must show for an estimate of the gain
  double max_shadow_brightness = 0.85;  ///< fraction of the background's brightness below which ground may be in shadow
  float noise_levels = 6;               ///< noise of the averages of two images, gray levels
  float spread_factor = 2.5F;           ///< multiple of the spread between views that noise explains
  float min_difference_levels = 25;     ///< smallest difference of a reflection or an object, gray levels
};
constexpr BackgroundParams kBackground{};

// Returns a color at another exposure, or nothing if it is saturated and its true value would be visible.
std::optional<cv::Vec3f> apply_gain(const cv::Vec3f& color, const cv::Vec3f& gain) {
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    if (color[c] >= kSaturated && gain[c] < 1) return std::nullopt;
    out[c] = std::min(color[c] * gain[c], 255.F);
  }
  return out;
}

std::optional<cv::Vec3f> sample_color(const View& view, const HalfSizeView& half, const Eigen::Vector3d& world) {
  const Eigen::Vector3d x = view.camera_from_world * world;
  if (!view.camera.in_front(x)) return std::nullopt;
  const cv::Point2f at = to_half_size(view.camera.project(x));
  if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(half.mask.cols - 1) &&
        at.y < static_cast<float>(half.mask.rows - 1)))
    return std::nullopt;
  if (half.mask(cvRound(at.y), cvRound(at.x)) != 0) return std::nullopt;
  return bilinear(half.image, at);
}

}  // namespace

std::optional<Eigen::Vector3d> intersect_ground(const View& view, const SE3& world_from_camera,
                                                const ground::ScanGround& ground, cv::Point half) {
  const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray(to_full_size(half));
  if (ray.z() > -1e-3 * ray.norm()) return std::nullopt;
  Eigen::Vector3d x = world_from_camera.t;
  for (int iteration = 0; iteration < kBackground.max_ground_iterations; ++iteration) {
    const auto height = ground.height(
        iteration == 0 ? Eigen::Vector2d(x.head<2>() + kBackground.first_ground_distance_m * ray.head<2>().normalized())
                       : Eigen::Vector2d(x.head<2>()));
    if (!height) return std::nullopt;
    const double length = (*height - world_from_camera.t.z()) / ray.z();
    if (length < 0 || length * ray.norm() > kBackground.max_ground_distance_m) return std::nullopt;
    const Eigen::Vector3d before = std::exchange(x, world_from_camera.t + length * ray);
    if ((x - before).squaredNorm() < kBackground.ground_tolerance_m * kBackground.ground_tolerance_m) break;
  }
  return x;
}

BackgroundViews::BackgroundViews(const Views& views, int blur_px, double max_distance_ratio)
    : views_(views),
      half_size_views_(
          views.size(),
          [views, blur_px](std::size_t i) { return make_half_size_view(*views.images[i], *views.masks[i], blur_px); }),
      max_distance_ratio_(max_distance_ratio) {}

std::vector<std::vector<cv::Vec3f>> BackgroundViews::sample_colors(const BackgroundQuery& query) const {
  std::vector<std::vector<cv::Vec3f>> colors(query.pixels.size());
  for (const std::size_t source : select_sources(query)) add_colors(source, query, colors);
  return colors;
}

std::vector<std::size_t> BackgroundViews::select_sources(const BackgroundQuery& query) const {
  std::vector<std::size_t> sources;
  for (const double offset_s : query.time_offsets_s)
    for (const int sign : {-1, 1}) {
      const std::int64_t time = views_[query.target].time_ns + sign * std::llround(1e9 * offset_s);
      const auto after = std::lower_bound(views_.views.begin(), views_.views.end(), time,
                                          [](const View& view, std::int64_t t) { return view.time_ns < t; });
      if (after == views_.views.end() || (after == views_.views.begin() && after->time_ns > time)) continue;
      sources.push_back(static_cast<std::size_t>(after - views_.views.begin()));
    }
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  std::erase(sources, query.target);
  return sources;
}

std::optional<cv::Vec3f> BackgroundViews::estimate_gain(const View& view, const HalfSizeView& half,
                                                        const BackgroundQuery& query) const {
  const auto own = half_size_views_[query.target];
  std::array<std::vector<float>, 3> ratios;
  for (const HalfSizePixel& at : query.exposure_pixels)
    if (const auto there = sample_color(view, half, at.world);
        there && !is_saturated(*there) && !is_saturated(own->image(at.pixel)))
      for (int c = 0; c < 3; ++c) ratios[c].push_back(static_cast<float>(own->image(at.pixel)[c] + 1) / ((*there)[c] + 1));
  if (ratios[0].size() < kBackground.min_gain_samples) return std::nullopt;
  return cv::Vec3f(median(ratios[0]), median(ratios[1]), median(ratios[2]));
}

void BackgroundViews::add_colors(std::size_t source, const BackgroundQuery& query,
                                 std::vector<std::vector<cv::Vec3f>>& colors) const {
  const auto half = half_size_views_[source];
  const View &view = views_[source], &own_view = views_[query.target];
  const auto gain = estimate_gain(view, *half, query);
  if (!gain) return;
  const auto depth = [](const View& from, const Eigen::Vector3d& world) {
    return from.camera.depth(from.camera_from_world * world);
  };
  for (std::size_t i = 0; i < query.pixels.size(); ++i) {
    const Eigen::Vector3d& world = query.pixels[i].world;
    if (depth(view, world) > max_distance_ratio_ * depth(own_view, world)) continue;
    if (const auto there = sample_color(view, *half, world))
      if (const auto here = apply_gain(*there, *gain)) colors[i].push_back(*here);
  }
}

BackgroundModel::BackgroundModel(const std::vector<HalfSizePixel>& pixels, const std::vector<std::vector<cv::Vec3f>>& colors,
                                 cv::Size size, int window_px)
    : median_(size, cv::Vec3f::all(0)),
      low_(size, cv::Vec3f::all(1e9F)),
      high_(size, cv::Vec3f::all(-1e9F)),
      spread_(size, cv::Vec3f::all(-1)) {
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (colors[i].size() < kMinBackgroundViews) continue;
    const cv::Point at = pixels[i].pixel;
    for (int c = 0; c < 3; ++c) {
      std::vector<float> values;
      for (const cv::Vec3f& color : colors[i]) values.push_back(color[c]);
      const float middle = median(values);
      for (float& value : values) value = std::abs(value - middle);
      median_(at)[c] = low_(at)[c] = high_(at)[c] = middle;
      spread_(at)[c] = median(values);
    }
  }
  const cv::Mat window = cv::Mat1b::ones(window_px, window_px);
  cv::erode(low_, low_, window);
  cv::dilate(high_, high_, window);
}

bool BackgroundModel::differs(cv::Point pixel, const cv::Vec3f& color) const {
  bool darker = true, other = false;
  for (int c = 0; c < 3; ++c) {
    const float low = low_(pixel)[c], high = high_(pixel)[c], spread = kBackground.spread_factor * spread_(pixel)[c];
    darker = darker && color[c] < kBackground.max_shadow_brightness * low && low - color[c] > kBackground.noise_levels + spread;
    other = other || std::max(low - color[c], color[c] - high) > kBackground.min_difference_levels + spread;
  }
  return darker || other;
}

float BackgroundModel::difference(cv::Point pixel, const cv::Vec3f& color) const {
  float largest = 0;
  for (int c = 0; c < 3; ++c)
    largest = std::max(largest, std::abs(color[c] - median_(pixel)[c]) /
                                    (kBackground.noise_levels + kBackground.spread_factor * spread_(pixel)[c]));
  return largest;
}

}  // namespace dvi::objects
