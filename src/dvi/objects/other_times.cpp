#include "dvi/objects/other_times.h"

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

constexpr double kFarthest = 60;        // meters
constexpr double kSettledVotes = 1e-3;  // meters
constexpr double kDarker = 0.85;        // part of its usual brightness below which ground may be in shadow
constexpr float kNoise = 6;             // levels: of two images' averages
constexpr float kSpreads = 2.5F;        // times the usual spread between views
constexpr float kDifference = 25;       // levels by which a reflection differs at least

// A color in another light, as far as a camera shows it; none where it shows less than there was.
std::optional<cv::Vec3f> in_light(const cv::Vec3f& color, const cv::Vec3f& gain) {
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    if (color[c] >= kSaturated && gain[c] < 1) return std::nullopt;
    out[c] = std::min(color[c] * gain[c], 255.F);
  }
  return out;
}

}  // namespace

std::optional<Eigen::Vector3d> on_ground(const View& view, const SE3& world_from_camera, const ground::ScanGround& ground,
                                         cv::Point half) {
  constexpr int kRounds = 6;
  const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray(full_size(half));
  if (ray.z() > -1e-3 * ray.norm()) return std::nullopt;
  Eigen::Vector3d x = world_from_camera.t;
  for (int round = 0; round < kRounds; ++round) {
    const auto height = ground.height(round == 0 ? Eigen::Vector2d(x.head<2>() + 10 * ray.head<2>().normalized())
                                                 : Eigen::Vector2d(x.head<2>()));
    if (!height) return std::nullopt;
    const double length = (*height - world_from_camera.t.z()) / ray.z();
    if (length < 0 || length * ray.norm() > kFarthest) return std::nullopt;
    const Eigen::Vector3d before = std::exchange(x, world_from_camera.t + length * ray);
    if ((x - before).squaredNorm() < kSettledVotes * kSettledVotes) break;
  }
  return x;
}

OtherTimes::OtherTimes(const Views& views, int blur, double coarsest)
    : views_(views),
      half_(views.size(), [views, blur](std::size_t i) { return half_view(*views.images[i], *views.masks[i], blur); }),
      coarsest_(coarsest) {}

std::vector<std::vector<cv::Vec3f>> OtherTimes::colors(std::size_t target, std::span<const double> apart,
                                                       const std::vector<HalfSizePixel>& places,
                                                       const std::vector<HalfSizePixel>& light) const {
  std::vector<std::vector<cv::Vec3f>> seen(places.size());
  for (const std::size_t source : sources_of(target, apart)) look(target, source, places, light, seen);
  return seen;
}

std::vector<std::size_t> OtherTimes::sources_of(std::size_t target, std::span<const double> apart) const {
  std::vector<std::size_t> sources;
  for (const double seconds : apart)
    for (const int way : {-1, 1}) {
      const std::int64_t time = views_[target].time_ns + way * std::llround(1e9 * seconds);
      const auto after = std::lower_bound(views_.views.begin(), views_.views.end(), time,
                                          [](const View& view, std::int64_t t) { return view.time_ns < t; });
      if (after == views_.views.end() || (after == views_.views.begin() && after->time_ns > time)) continue;
      sources.push_back(static_cast<std::size_t>(after - views_.views.begin()));
    }
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  std::erase(sources, target);
  return sources;
}

std::optional<cv::Vec3f> OtherTimes::color(const View& view, const HalfView& half, const Eigen::Vector3d& world) const {
  const Eigen::Vector3d x = view.camera_from_world * world;
  if (!view.camera.in_front(x)) return std::nullopt;
  const cv::Point2f at = half_size(view.camera.project(x));
  if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(half.mask.cols - 1) &&
        at.y < static_cast<float>(half.mask.rows - 1)))
    return std::nullopt;
  if (half.mask(cvRound(at.y), cvRound(at.x)) != 0) return std::nullopt;
  return bilinear(half.image, at);
}

// Adds what a source shows of the places.
void OtherTimes::look(std::size_t target, std::size_t source, const std::vector<HalfSizePixel>& places,
                      const std::vector<HalfSizePixel>& light, std::vector<std::vector<cv::Vec3f>>& seen) const {
  const auto half = half_[source], own = half_[target];
  const View &view = views_[source], &own_view = views_[target];
  std::array<std::vector<float>, 3> ratios;
  for (const HalfSizePixel& place : light)
    if (const auto there = color(view, *half, place.world);
        there && !is_saturated(*there) && !is_saturated(own->image(place.at)))
      for (int c = 0; c < 3; ++c) ratios[c].push_back((own->image(place.at)[c] + 1) / ((*there)[c] + 1));
  if (ratios[0].size() < 20) return;
  const cv::Vec3f gain(median(ratios[0]), median(ratios[1]), median(ratios[2]));
  const auto depth = [](const View& from, const Eigen::Vector3d& world) { return (from.camera_from_world * world).z(); };
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (depth(view, places[i].world) > coarsest_ * depth(own_view, places[i].world)) continue;
    if (const auto there = color(view, *half, places[i].world))
      if (const auto here = in_light(*there, gain)) seen[i].push_back(*here);
  }
}

Usual::Usual(const std::vector<HalfSizePixel>& places, const std::vector<std::vector<cv::Vec3f>>& seen, cv::Size size,
             int around)
    : middle(size, cv::Vec3f::all(0)),
      low(size, cv::Vec3f::all(1e9F)),
      high(size, cv::Vec3f::all(-1e9F)),
      spread(size, cv::Vec3f::all(-1)) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (seen[i].size() < kFewestViews) continue;
    for (int c = 0; c < 3; ++c) {
      std::vector<float> values;
      for (const cv::Vec3f& color : seen[i]) values.push_back(color[c]);
      const float usual = median(values);
      for (float& value : values) value = std::abs(value - usual);
      middle(places[i].at)[c] = low(places[i].at)[c] = high(places[i].at)[c] = usual;
      spread(places[i].at)[c] = median(values);
    }
  }
  const cv::Mat square = cv::Mat1b::ones(around, around);
  cv::erode(low, low, square);
  cv::dilate(high, high, square);
}

bool Usual::excludes(cv::Point at, const cv::Vec3f& here) const {
  bool darker = true, other = false;
  for (int c = 0; c < 3; ++c) {
    const float least = low(at)[c], most = high(at)[c], off = kSpreads * spread(at)[c];
    darker = darker && here[c] < kDarker * least && least - here[c] > kNoise + off;
    other = other || std::max(least - here[c], here[c] - most) > kDifference + off;
  }
  return darker || other;
}

float Usual::difference(cv::Point at, const cv::Vec3f& here) const {
  float most = 0;
  for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(here[c] - middle(at)[c]) / (kNoise + kSpreads * spread(at)[c]));
  return most;
}

}  // namespace dvi::objects
