#include "dvi/objects/background_comparison.h"

#include <array>
#include <optional>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace dvi::objects {
namespace {

struct BackgroundComparisonParams {
  /// Seconds, earlier and later. The nearest views show the background with the smallest position error, the others show it
  /// after the object has left.
  std::array<double, 8> time_offsets_s{0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0};
  int blur_px = 1;                 ///< pixels of half size: none, because roof rails and mirrors are thin
  int window_px = 3;               ///< pixels of half size: poses and depths have errors of one pixel in each direction
  int exposure_step_px = 12;       ///< pixels of half size between the samples for the exposure
  double no_return_depth_m = 1e4;  ///< depth of surfaces beyond the range of the scans
};
constexpr BackgroundComparisonParams kComparison{};

}  // namespace

BackgroundComparison::BackgroundComparison(const Views& views, Lazy<cv::Mat1f> static_depth,
                                           std::shared_ptr<const ground::ScanGround> ground)
    : others_(views, kComparison.blur_px), static_depth_(std::move(static_depth)), ground_(std::move(ground)) {}

ImageDifference BackgroundComparison::compare(std::size_t target, const cv::Mat1b& band) const {
  const auto half = half_size_view(target);
  const std::vector<HalfSizePixel> pixels = find_background(target, band, 1);
  const std::vector<HalfSizePixel> exposure = find_background(target, cv::Mat1b(half->mask == 0), kComparison.exposure_step_px);
  const auto colors = others_.sample_colors({target, kComparison.time_offsets_s, pixels, exposure});
  ImageDifference out{BackgroundModel(pixels, colors, band.size(), kComparison.window_px), {}, {}, {}, {}};
  for (cv::Mat1b* mask : {&out.differs, &out.undecided, &out.ground, &out.matches}) *mask = cv::Mat1b(band.size(), uchar{0});
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const cv::Point at = pixels[i].pixel;
    if (pixels[i].on_ground) out.ground(at) = 255;
    if (colors[i].size() < kMinBackgroundViews)
      out.undecided(at) = 255;
    else if (out.background.differs(at, half->image(at)))
      out.differs(at) = 255;
    else if (out.background.matches(at, half->image(at)))
      out.matches(at) = 255;
  }
  cv::medianBlur(out.differs, out.differs, 3);
  return out;
}

// Returns every `step`-th pixel of a mask with its background: the nearer one of the ground and the static surface above it,
// else a point at a large distance.
std::vector<HalfSizePixel> BackgroundComparison::find_background(std::size_t target, const cv::Mat1b& where, int step) const {
  std::vector<HalfSizePixel> out;
  const View& view = views()[target];
  const SE3 world_from_camera = view.camera_from_world.inverse();
  const auto depth = static_depth_[target];
  for (int y = 0; y < where.rows; y += step)
    for (int x = 0; x < where.cols; x += step) {
      if (where(y, x) == 0) continue;
      const auto ground = intersect_ground(view, world_from_camera, *ground_, {x, y});
      const double z = (*depth)(y, x) > 0 ? static_cast<double>((*depth)(y, x)) : kComparison.no_return_depth_m;
      const bool on_ground = ground && view.camera.depth(view.camera_from_world * *ground) < z;
      const Eigen::Vector3d surface = world_from_camera * Eigen::Vector3d(z * view.camera.ray(to_full_size({x, y})));
      out.push_back({{x, y}, on_ground ? *ground : surface, on_ground});
    }
  return out;
}

}  // namespace dvi::objects
