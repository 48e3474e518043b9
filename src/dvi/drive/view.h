#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/matx.hpp>

#include "dvi/core/lazy.h"
#include "dvi/drive/sensor.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// A posed image: one frame of a sequence, which is what one camera saw on one drive. After the map is made, stages know views
/// only, whichever drive or camera they come from.
struct View {
  int sequence = 0;       ///< 0 is the target's
  std::size_t frame = 0;  ///< its index in that sequence
  std::int64_t time_ns = 0;
  Camera camera;
  SE3 camera_from_world;
  cv::Vec3f gain{1, 1, 1};        ///< BGR; its colors times this are in the light common to all views
  float vignetting = 0;           ///< how its lens darkens toward the corners: k of vignetting(), 0 if it does not
  Sensor sensor = Sensor::lidar;  ///< its drive's
  bool registered_depth = false;  ///< its drive's: nothing turns the camera against the sensor that made the map
  bool gray = false;              ///< shows structure, but no colors
  int drive = 0;                  ///< 0 is the target's; the cameras of one drive share it, and only their times compare
};

/// What brings the colors of one view (by its gain) into the light of another.
inline cv::Vec3f gain_to(const cv::Vec3f& target, const cv::Vec3f& source) {
  return {source[0] / target[0], source[1] / target[1], source[2] / target[2]};
}
inline cv::Vec3f gain_to(const View& target, const View& source) { return gain_to(target.gain, source.gain); }

/// Whether colors of one may stand in the other: both are in color, or both gray. Structure may be compared in any case.
inline bool shares_colors(const View& a, const View& b) { return a.gray == b.gray; }

/// All views: those of the target first, in time order, then sequence after sequence. A view's index is its source number.
struct Views {
  std::vector<View> views;
  Lazy<cv::Mat3b> images;  ///< as `views`
  Lazy<cv::Mat1b> masks;   ///< as `views`; 255 = remove

  std::size_t size() const { return views.size(); }
  const View& operator[](std::size_t i) const { return views[i]; }
  /// The number of the last sequence, plus one.
  int sequences() const { return views.empty() ? 0 : views.back().sequence + 1; }
  /// Views [first, last) of a sequence.
  std::pair<std::size_t, std::size_t> of_sequence(int sequence) const {
    const auto begin_of = [this](int number) {
      const auto at = std::partition_point(views.begin(), views.end(), [&](const View& v) { return v.sequence < number; });
      return static_cast<std::size_t>(at - views.begin());
    };
    return {begin_of(sequence), begin_of(sequence + 1)};
  }
};

}  // namespace dvi
