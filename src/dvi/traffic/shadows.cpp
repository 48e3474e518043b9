#include "dvi/traffic/shadows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/drive/outline.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"

namespace dvi::traffic {
namespace {

constexpr int kScale = 2;         // images are compared at half their size: shadows are large, poses good to a pixel
constexpr double kFarthest = 60;  // metres: beyond, a pixel covers metres of ground
constexpr std::array kApart{0.3, 0.5, 0.7, 1.0, 1.3,
                            1.6, 2.0, 2.5, 3.0, 4.0};  // seconds, both ways: what moves has left the place
constexpr std::size_t kFewestViews = 2;
constexpr double kDarker = 0.85;   // part of its usual brightness below which ground may be in shadow
constexpr float kNoise = 6;        // levels: of two images' averages
constexpr float kSpreads = 2.5F;   // times the usual spread between views
constexpr float kDifference = 25;  // levels by which a reflection differs at least
constexpr int kMisplaced = 5;      // half pixels across: what poses and the ground are wrong by, each way two
constexpr int kTouch = 3;          // half pixels between an object's mask and its shadow
constexpr int kSpeck = 20;         // half pixels, of a part: smaller ones are noise
constexpr int kLight = 12;         // half pixels between the places at which light is compared

using Patch = cv::Mat_<cv::Vec3f>;

// A view's image at half size, smoothed over what poses are wrong by.
struct Small {
  Patch image;
  cv::Mat1b mask;  // 255 where any of the pixels is masked

  std::size_t bytes() const { return bytes_of(image) + bytes_of(mask); }
};

Small small_of(const cv::Mat3b& image, const cv::Mat1b& mask) {
  Small out;
  const cv::Size size(image.cols / kScale, image.rows / kScale);
  cv::Mat3b half;
  cv::resize(image, half, size, 0, 0, cv::INTER_AREA);
  cv::blur(half, half, {3, 3});
  half.convertTo(out.image, CV_32FC3);
  cv::resize(grown(mask, kScale), out.mask, size, 0, 0, cv::INTER_NEAREST);
  return out;
}

Eigen::Vector2d full_size(cv::Point half) {
  return {kScale * half.x + 0.5 * (kScale - 1), kScale * half.y + 0.5 * (kScale - 1)};
}

cv::Point2f half_size(const Eigen::Vector2d& full) {
  return {static_cast<float>((full.x() - 0.5 * (kScale - 1)) / kScale),
          static_cast<float>((full.y() - 0.5 * (kScale - 1)) / kScale)};
}

// Where a pixel's ray meets the ground; none above the horizon, beyond the farthest or where nobody scanned.
std::optional<Eigen::Vector3d> on_ground(const View& view, const SE3& world_from_camera, const Ground& ground, cv::Point half) {
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
    x = world_from_camera.t + length * ray;
  }
  return x;
}

struct GroundPixel {
  cv::Point at;  // half size
  Eigen::Vector3d world;
};

// What ground looks like at other times: between the medians of what the views show of the pixels around, because poses are
// wrong by some, give or take the spread between views.
class Usual {
 public:
  Usual(const std::vector<GroundPixel>& band, const std::vector<std::vector<cv::Vec3f>>& seen, cv::Size size)
      : low_(size, cv::Vec3f::all(1e9F)), high_(size, cv::Vec3f::all(-1e9F)), spread_(size, cv::Vec3f::all(0)) {
    for (std::size_t i = 0; i < band.size(); ++i) {
      if (seen[i].size() < kFewestViews) continue;
      for (int c = 0; c < 3; ++c) {
        std::vector<float> values;
        for (const cv::Vec3f& colour : seen[i]) values.push_back(colour[c]);
        const float middle = median(values);
        for (float& value : values) value = std::abs(value - middle);
        low_(band[i].at)[c] = high_(band[i].at)[c] = middle;
        spread_(band[i].at)[c] = median(values);
      }
    }
    const cv::Mat around = cv::Mat1b::ones(kMisplaced, kMisplaced);
    cv::erode(low_, low_, around);
    cv::dilate(high_, high_, around);
  }

  // Darker as in a shadow, or otherwise different.
  bool excludes(cv::Point at, const cv::Vec3f& here) const {
    bool darker = true, other = false;
    for (int c = 0; c < 3; ++c) {
      const float low = low_(at)[c], high = high_(at)[c], off = kSpreads * spread_(at)[c];
      darker = darker && here[c] < kDarker * low && low - here[c] > kNoise + off;
      other = other || std::max(low - here[c], here[c] - high) > kDifference + off;
    }
    return darker || other;
  }

 private:
  Patch low_, high_, spread_;
};

class Finder {
 public:
  Finder(const Views& views, std::shared_ptr<const Ground> ground)
      : views_(views),
        ground_(std::move(ground)),
        small_(views.size(), [views](std::size_t i) { return small_of(*views.images[i], *views.masks[i]); }) {}

  cv::Mat1b operator()(std::size_t target) const {
    const cv::Mat1b mask = *views_.masks[target];
    if (cv::countNonZero(mask) == 0) return mask;
    const auto small = small_[target];
    const std::vector<GroundPixel> band = ground_pixels(target, band_round(small->mask), 1);
    const std::vector<GroundPixel> light = ground_pixels(target, cv::Mat1b(small->mask == 0), kLight);
    std::vector<std::vector<cv::Vec3f>> seen(band.size());
    for (const std::size_t source : sources_of(target)) look(*small, source, band, light, seen);
    cv::Mat1b differs(small->mask.size(), uchar{0}), unseen = differs.clone();
    const Usual usual(band, seen, small->mask.size());
    for (std::size_t i = 0; i < band.size(); ++i)
      if (seen[i].size() < kFewestViews)
        unseen(band[i].at) = 255;
      else if (usual.excludes(band[i].at, small->image(band[i].at)))
        differs(band[i].at) = 255;
    cv::medianBlur(differs, differs, 3);
    return joined(mask, small->mask, differs, unseen);
  }

 private:
  std::vector<std::size_t> sources_of(std::size_t target) const {
    std::vector<std::size_t> sources;
    for (const double apart : kApart)
      for (const int way : {-1, 1}) {
        const std::int64_t time = views_[target].time_ns + way * std::llround(1e9 * apart);
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

  // As far round each part as it is high: shadows of a sun above 45 degrees; lower ones are cut.
  static cv::Mat1b band_round(const cv::Mat1b& mask) {
    cv::Mat1b band(mask.size(), uchar{0});
    for (const cv::Rect& part : part_boxes(mask)) {
      const int reach = std::clamp(part.height, 8, mask.cols / 8);
      const cv::Rect box(part.x - reach, part.y, part.width + 2 * reach, part.height + reach);
      band(box & cv::Rect({}, mask.size())) = 255;
    }
    band.setTo(0, mask);
    return band;
  }

  std::vector<GroundPixel> ground_pixels(std::size_t target, const cv::Mat1b& where, int every) const {
    std::vector<GroundPixel> out;
    const SE3 world_from_camera = views_[target].camera_from_world.inverse();
    for (int y = 0; y < where.rows; y += every)
      for (int x = 0; x < where.cols; x += every)
        if (where(y, x) != 0)
          if (const auto world = on_ground(views_[target], world_from_camera, *ground_, {x, y}))
            out.push_back({{x, y}, *world});
    return out;
  }

  std::optional<cv::Vec3f> colour(const View& view, const Small& small, const Eigen::Vector3d& world) const {
    const Eigen::Vector3d x = view.camera_from_world * world;
    if (!view.camera.in_front(x)) return std::nullopt;
    const cv::Point2f at = half_size(view.camera.project(x));
    if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(small.mask.cols - 1) &&
          at.y < static_cast<float>(small.mask.rows - 1)))
      return std::nullopt;
    if (small.mask(cvRound(at.y), cvRound(at.x)) != 0) return std::nullopt;
    return bilinear(small.image, at);
  }

  // Adds what a source shows of the band, in the target's light.
  void look(const Small& target, std::size_t source, const std::vector<GroundPixel>& band,
            const std::vector<GroundPixel>& light, std::vector<std::vector<cv::Vec3f>>& seen) const {
    const auto small = small_[source];
    const View& view = views_[source];
    std::array<std::vector<float>, 3> ratios;
    for (const GroundPixel& pixel : light)
      if (const auto there = colour(view, *small, pixel.world))
        for (int c = 0; c < 3; ++c) ratios[c].push_back((target.image(pixel.at)[c] + 1) / ((*there)[c] + 1));
    if (ratios[0].size() < 20) return;
    const cv::Vec3f gain(median(ratios[0]), median(ratios[1]), median(ratios[2]));
    for (std::size_t i = 0; i < band.size(); ++i)
      if (const auto there = colour(view, *small, band[i].world)) seen[i].push_back(there->mul(gain));
  }

  // What differs and hangs together with the mask, if need be across ground that nobody else saw; at full size.
  static cv::Mat1b joined(const cv::Mat1b& mask, const cv::Mat1b& small_mask, const cv::Mat1b& differs,
                          const cv::Mat1b& unseen) {
    cv::Mat1i parts;
    const int count = connected_parts(cv::Mat1b(differs | unseen), parts);
    const cv::Mat1b near = grown(small_mask, kTouch);
    std::vector<int> pixels(static_cast<std::size_t>(count) + 1, 0);
    std::vector<bool> touches(pixels.size(), false);
    for (int y = 0; y < parts.rows; ++y)
      for (int x = 0; x < parts.cols; ++x) {
        const auto part = static_cast<std::size_t>(parts(y, x));
        if (differs(y, x) != 0) ++pixels[part];
        if (near(y, x) != 0) touches[part] = true;
      }
    cv::Mat1b shadow(differs.size(), uchar{0});
    for (int y = 0; y < parts.rows; ++y)
      for (int x = 0; x < parts.cols; ++x)
        if (const auto part = static_cast<std::size_t>(parts(y, x));
            differs(y, x) != 0 && touches[part] && pixels[part] >= kSpeck)
          shadow(y, x) = 255;
    cv::Mat1b full;
    cv::resize(grown(shadow, 2), full, mask.size(), 0, 0, cv::INTER_NEAREST);
    return cv::Mat1b(full | mask);
  }

  Views views_;
  std::shared_ptr<const Ground> ground_;
  Lazy<Small> small_;
};

}  // namespace

Lazy<cv::Mat1b> with_shadows(const Views& views, const std::shared_ptr<const Ground>& ground) {
  const auto finder = std::make_shared<const Finder>(views, ground);
  // Found once: a mask that the shared budget drops is drawn again from its outline, some kilobytes that are always kept.
  const Lazy<Instance> outlines(views.size(), views.size(), [finder](std::size_t i) { return outline_of((*finder)(i)); });
  return {views.size(), [outlines](std::size_t i) {
            const auto outline = outlines[i];
            cv::Mat1b mask(outline->size, uchar{0});
            draw(*outline, mask);
            return mask;
          }};
}

}  // namespace dvi::traffic
