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

/// A pixel of a view at half size, and what stands there.
struct HalfSizePixel {
  cv::Point at;
  Eigen::Vector3d world;
  bool on_ground = true;
};

/// Where a pixel's ray meets the ground; none above the horizon, beyond 60 m (a pixel covers meters of ground there) or where
/// nobody scanned.
std::optional<Eigen::Vector3d> on_ground(const View& view, const SE3& world_from_camera, const ground::ScanGround& ground,
                                         cv::Point half);

/// What the places of one view look like in others of its drive, taken at other times.
class OtherTimes {
 public:
  /// `blur`: as of half_view(). `coarsest`: views that are so many times as far from a place do not count.
  OtherTimes(const Views& views, int blur, double coarsest = 1e9);

  const Views& views() const { return views_; }
  std::shared_ptr<const HalfView> half(std::size_t view) const { return half_[view]; }

  /// The colors of each place outside the masks of the views so many seconds earlier and later, in the light of the target:
  /// the median ratio over all places of `light` that both show.
  std::vector<std::vector<cv::Vec3f>> colors(std::size_t target, std::span<const double> apart,
                                             const std::vector<HalfSizePixel>& places,
                                             const std::vector<HalfSizePixel>& light) const;

 private:
  std::vector<std::size_t> sources_of(std::size_t target, std::span<const double> apart) const;
  std::optional<cv::Vec3f> color(const View& view, const HalfView& half, const Eigen::Vector3d& world) const;
  void look(std::size_t target, std::size_t source, const std::vector<HalfSizePixel>& places,
            const std::vector<HalfSizePixel>& light, std::vector<std::vector<cv::Vec3f>>& seen) const;

  Views views_;
  Lazy<HalfView> half_;
  double coarsest_;
};

inline constexpr std::size_t kFewestViews = 2;  ///< that must show a place

/// What places look like at other times: between the medians of what the views show of the pixels around, because poses are
/// wrong by some, give or take the spread between views.
class Usual {
 public:
  /// `around`: pixels across that poses and places are wrong by.
  Usual(const std::vector<HalfSizePixel>& places, const std::vector<std::vector<cv::Vec3f>>& seen, cv::Size size, int around);

  /// Darker as in a shadow, or otherwise different.
  bool excludes(cv::Point at, const cv::Vec3f& here) const;
  /// The place itself, as other times show it, beyond chance; what merely looks like its surroundings may be hiding it.
  bool shows(cv::Point at, const cv::Vec3f& here) const { return difference(at, here) <= 1; }
  /// From what other times show at the place; 1: the most that chance explains.
  float difference(cv::Point at, const cv::Vec3f& here) const;
  bool seen(cv::Point at) const { return spread(at)[0] >= 0; }

  Patch middle, low, high, spread;  // low above high, and spread negative, where no source observed
};

}  // namespace dvi::objects
