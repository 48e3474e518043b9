#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/matx.hpp>

#include "dvi/core/lazy.h"
#include "dvi/drive/image_returns.h"
#include "dvi/drive/sensor.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// A posed image: one frame of a sequence, which has the images of one camera on one drive. After the map is built, stages use
/// views only, independent of their drive and camera.
struct View {
  int sequence = 0;       ///< 0 is that of the target's first camera
  std::size_t frame = 0;  ///< index in the sequence
  std::int64_t time_ns = 0;
  Camera camera;
  SE3 camera_from_world;
  cv::Vec3f gain{1, 1, 1};        ///< BGR factor from its colors to the illumination common to all views
  float vignetting = 0;           ///< k of vignetting(), the darkening of its lens toward the corners; 0: none
  Sensor sensor = Sensor::lidar;  ///< that of its drive
  bool registered_depth = false;  ///< that of its drive: the extrinsics are exact
  bool gray = false;              ///< whether it shows structure, but no colors
  int drive = 0;                  ///< 0 is that of the target; times are comparable only within a drive
};

/// Returns the factor from the colors of one view to the illumination of another one, by their gains.
inline cv::Vec3f gain_to(const cv::Vec3f& target, const cv::Vec3f& source) {
  return {source[0] / target[0], source[1] / target[1], source[2] / target[2]};
}
inline cv::Vec3f gain_to(const View& target, const View& source) { return gain_to(target.gain, source.gain); }

/// Returns whether colors of one view can be copied to the other one: both are in color, or both gray. Structure can always be
/// compared.
inline bool shares_colors(const View& a, const View& b) { return a.gray == b.gray; }

/// All views: those of the target's cleaned cameras, each in order of time, then those of each other sequence. The index of a
/// view is its source number.
struct Views {
  std::vector<View> views;
  Lazy<cv::Mat3b> images;                    ///< one per view
  Lazy<cv::Mat1b> masks;                     ///< one per view; 255 = remove
  Lazy<std::vector<ImageReturn>> returns{};  ///< one per view: the returns of the scan taken with it; empty: unknown
  /// One per view: 255 where its objects are unknown, so that nothing is copied from there; an empty image if all are known.
  /// Empty: all are known.
  Lazy<cv::Mat1b> unknown{};
  int cleaned_sequences = 1;  ///< the first sequences, whose views are filled

  std::size_t size() const { return views.size(); }
  const View& operator[](std::size_t i) const { return views[i]; }
  /// Returns the number of the last sequence plus one.
  int sequences() const { return views.empty() ? 0 : views.back().sequence + 1; }
  /// Returns the views [first, last) of a sequence.
  std::pair<std::size_t, std::size_t> of_sequence(int sequence) const {
    const auto begin_of = [this](int number) {
      const auto at = std::partition_point(views.begin(), views.end(), [&](const View& v) { return v.sequence < number; });
      return static_cast<std::size_t>(at - views.begin());
    };
    return {begin_of(sequence), begin_of(sequence + 1)};
  }
  /// Returns the views that are filled in order of time; those of the first camera first at equal times.
  std::vector<std::size_t> targets_in_time() const {
    std::vector<std::size_t> order(targets());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return views[a].time_ns < views[b].time_ns; });
    return order;
  }
  /// Returns the number of views that are filled: [0, targets()).
  std::size_t targets() const { return of_sequence(cleaned_sequences - 1).second; }
};

}  // namespace dvi
