#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/objects/half_size.h"

namespace dvi::objects {

/// A pixel of a view at half size and the surface that it shows.
struct HalfSizePixel {
  cv::Point pixel;
  Eigen::Vector3d world;  ///< meters
  bool on_ground = true;
};

/// Intersects the ray of a pixel of half size with the ground. Returns nothing above the horizon, beyond 60 m, where a pixel
/// covers meters of ground, and where no scan shows the ground.
std::optional<Eigen::Vector3d> intersect_ground(const View& view, const SE3& world_from_camera,
                                                const ground::ScanGround& ground, cv::Point half);

/// Pixels whose background is sampled in views of other times.
struct BackgroundQuery {
  std::size_t target = 0;                             ///< view of the pixels
  std::span<const double> time_offsets_s;             ///< views of these offsets, earlier and later, are sampled
  const std::vector<HalfSizePixel>& pixels;           ///< pixels to sample
  const std::vector<HalfSizePixel>& exposure_pixels;  ///< pixels whose median ratio of colors equalizes the exposure
};

/// Samples the surfaces of one view in other views of its drive, taken at other times.
class BackgroundViews {
 public:
  /// `blur_px` is as for make_half_size_view(). Views at more than `max_distance_ratio` times the distance to a surface do not
  /// count.
  explicit BackgroundViews(const Views& views, int blur_px, double max_distance_ratio = 1e9);

  const Views& views() const { return views_; }
  std::shared_ptr<const HalfSizeView> half_size_view(std::size_t view) const { return half_size_views_[view]; }

  /// Returns, per pixel, its colors outside the masks of the sampled views, at the exposure of the target.
  std::vector<std::vector<cv::Vec3f>> sample_colors(const BackgroundQuery& query) const;

 private:
  std::vector<std::size_t> select_sources(const BackgroundQuery& query) const;
  std::optional<cv::Vec3f> estimate_gain(const View& view, const HalfSizeView& half, const BackgroundQuery& query) const;
  void add_colors(std::size_t source, const BackgroundQuery& query, std::vector<std::vector<cv::Vec3f>>& colors) const;

  Views views_;
  Lazy<HalfSizeView> half_size_views_;
  double max_distance_ratio_;
};

inline constexpr std::size_t kMinBackgroundViews = 2;  ///< views that must show a pixel's surface

/// The colors of the background, per pixel of half size: the range of the median colors within a window, because poses have
/// errors, and the spread between views.
class BackgroundModel {
 public:
  /// `colors` are per pixel. `window_px` is the side of the window, which covers the position error.
  BackgroundModel(const std::vector<HalfSizePixel>& pixels, const std::vector<std::vector<cv::Vec3f>>& colors, cv::Size size,
                  int window_px);

  /// Returns whether a color is darker than the background, as in a shadow, or otherwise outside its range.
  bool differs(cv::Point pixel, const cv::Vec3f& color) const;
  /// Returns whether a color is that of the background at the pixel itself, up to noise. A color within the range of the window
  /// is not sufficient: an object of the color of its surroundings may cover the pixel.
  bool matches(cv::Point pixel, const cv::Vec3f& color) const { return difference(pixel, color) <= 1; }
  /// Returns the difference of a color from the background at the pixel itself, relative to the largest that noise explains.
  float difference(cv::Point pixel, const cv::Vec3f& color) const;
  /// Returns whether enough views observe the background.
  bool is_observed(cv::Point pixel) const { return spread_(pixel)[0] >= 0; }

 private:
  cv::Mat3f median_, low_, high_, spread_;  // unobserved: low above high, and negative spread
};

}  // namespace dvi::objects
