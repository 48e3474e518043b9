#include "dvi/objects/shadows.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/image/region.h"
#include "dvi/objects/background_model.h"
#include "dvi/objects/cache_masks.h"
#include "dvi/objects/close_returns.h"

namespace dvi::objects {
namespace {

struct ShadowParams {
  /// Seconds, earlier and later: a moving object has left the ground by then.
  std::array<double, 10> time_offsets_s{0.3, 0.5, 0.7, 1.0, 1.3, 1.6, 2.0, 2.5, 3.0, 4.0};
  int blur_px = 3;                ///< pixels of half size: shadows are large, and position errors are as large
  double max_distance_ratio = 2;  ///< views from a larger distance do not resolve details of the ground
  int window_px = 5;              ///< pixels of half size: poses and ground have errors of two pixels in each direction
  int max_gap_px = 3;             ///< pixels of half size between an object's mask and its shadow
  int min_part_px = 20;           ///< pixels of half size; smaller parts are noise
  int margin_px = 2;              ///< pixels of half size around a shadow
  int exposure_step_px = 12;      ///< pixels of half size between the samples for the exposure
  int min_band_px = 8;            ///< pixels of half size around a part of the mask that are searched
  double min_height_m = 0.3;      ///< above the ground, of returns that lie on upright surfaces
  int view_width_bands = 8;       ///< width of a view in units of the widest searched band
};
constexpr ShadowParams kShadows{};

class ShadowFinder {
 public:
  ShadowFinder(const Views& views, std::shared_ptr<const ground::ScanGround> ground)
      : others_(views, kShadows.blur_px, kShadows.max_distance_ratio), ground_(std::move(ground)) {}

  cv::Mat1b add_shadow(std::size_t target) const {
    const cv::Mat1b mask = *others_.views().masks[target];
    if (cv::countNonZero(mask) == 0) return mask;
    const auto half = others_.half_size_view(target);
    cv::Mat1b band_mask = find_band(half->mask);
    band_mask.setTo(0, find_upright(target, band_mask.size()));
    const std::vector<HalfSizePixel> band = find_ground(target, band_mask, 1);
    const std::vector<HalfSizePixel> exposure = find_ground(target, cv::Mat1b(half->mask == 0), kShadows.exposure_step_px);
    const std::vector<std::vector<cv::Vec3f>> colors = others_.sample_colors({target, kShadows.time_offsets_s, band, exposure});
    cv::Mat1b differs(half->mask.size(), uchar{0}), unobserved = differs.clone();
    const BackgroundModel background(band, colors, half->mask.size(), kShadows.window_px);
    for (std::size_t i = 0; i < band.size(); ++i)
      if (colors[i].size() < kMinBackgroundViews)
        unobserved(band[i].pixel) = 255;
      else if (background.differs(band[i].pixel, half->image(band[i].pixel)))
        differs(band[i].pixel) = 255;
    cv::medianBlur(differs, differs, 3);
    cv::Mat1b shadow;
    cv::resize(grown(find_connected(half->mask, differs, unobserved), kShadows.margin_px), shadow, mask.size(), 0, 0,
               cv::INTER_NEAREST);
    return cv::Mat1b(shadow | mask);
  }

 private:
  // Returns the pixels beside and below each part, up to its height: shadows of a sun above 45 degrees. Longer ones are
  // truncated.
  static cv::Mat1b find_band(const cv::Mat1b& mask) {
    cv::Mat1b band(mask.size(), uchar{0});
    for (const cv::Rect& part : find_part_boxes(mask)) {
      const int width = std::clamp(part.height, kShadows.min_band_px, mask.cols / kShadows.view_width_bands);
      const cv::Rect box(part.x - width, part.y, part.width + 2 * width, part.height + width);
      band(box & cv::Rect({}, mask.size())) = 255;
    }
    band.setTo(0, mask);
    return band;
  }

  // Returns the pixels of half size that show upright surfaces, which hide the ground.
  cv::Mat1b find_upright(std::size_t target, cv::Size half) const {
    const Views& views = others_.views();
    if (views.returns.empty()) return {half, uchar{0}};
    const Camera& camera = views[target].camera;
    const SE3 world_from_camera = views[target].camera_from_world.inverse();
    cv::Mat1b returns(camera.height, camera.width, uchar{0});
    for (const ImageReturn& r : *views.returns[target]) {
      const Eigen::Vector3d world = world_from_camera * (static_cast<double>(r[2]) * camera.ray({r[0], r[1]}));
      const std::optional<double> ground_m = ground_->height(world.head<2>());
      if (ground_m && world.z() > *ground_m + kShadows.min_height_m) returns(cvRound(r[1]), cvRound(r[0])) = 255;
    }
    cv::Mat1b upright;
    cv::resize(close_returns(returns, camera), upright, half, 0, 0, cv::INTER_NEAREST);
    return upright;
  }

  // Returns every `step`-th pixel of a mask that shows the ground.
  std::vector<HalfSizePixel> find_ground(std::size_t target, const cv::Mat1b& where, int step) const {
    std::vector<HalfSizePixel> out;
    const View& view = others_.views()[target];
    const SE3 world_from_camera = view.camera_from_world.inverse();
    for (int y = 0; y < where.rows; y += step)
      for (int x = 0; x < where.cols; x += step)
        if (where(y, x) != 0)
          if (const auto world = intersect_ground(view, world_from_camera, *ground_, {x, y})) out.push_back({{x, y}, *world});
    return out;
  }

  // Returns the differing pixels that are connected to the mask, directly or across unobserved ground.
  static cv::Mat1b find_connected(const cv::Mat1b& mask, const cv::Mat1b& differs, const cv::Mat1b& unobserved) {
    cv::Mat1i parts;
    const int count = label_connected_parts(cv::Mat1b(differs | unobserved), parts);
    const cv::Mat1b near = grown(mask, kShadows.max_gap_px);
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
            differs(y, x) != 0 && touches[part] && pixels[part] >= kShadows.min_part_px)
          shadow(y, x) = 255;
    return shadow;
  }

  BackgroundViews others_;
  std::shared_ptr<const ground::ScanGround> ground_;
};

}  // namespace

Lazy<cv::Mat1b> add_shadows(const Views& views, const std::shared_ptr<const ground::ScanGround>& ground) {
  const auto finder = std::make_shared<const ShadowFinder>(views, ground);
  return cache_masks(views.size(), [finder](std::size_t i) { return finder->add_shadow(i); });
}

}  // namespace dvi::objects
