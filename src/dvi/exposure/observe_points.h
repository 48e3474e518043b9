#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/visible_points.h"

namespace dvi::exposure {

/// The observation of a map point in a view.
struct PointObservation {
  std::size_t point = 0;  ///< index in the map
  cv::Vec3f color;        ///< logarithm of the color, BGR
  float off_axis = 0;     ///< distance from the optical axis, as by compute_off_axis()
};

/// The observations of a view, in order of points.
using PointObservations = std::vector<PointObservation>;

/// Parameters of the observations.
struct ObservationParams {
  double blur_px = 2.5;     ///< standard deviation; poses are not refined yet
  int margin_px = 6;        ///< around masks and saturated pixels, because of the blur
  unsigned char black = 8;  ///< gray level below which noise and the offset of the sensor dominate
};
inline constexpr ObservationParams kObservation;

/// Collects the colors of the visible map points that are unmasked and neither black nor saturated.
PointObservations observe_points(const View& view, const std::vector<map::VisiblePoint>& points, const cv::Mat3b& image,
                                 const cv::Mat1b& mask);

/// Calls `visit` with both observations of each point that both views show.
template <class Visit>
void for_each_shared(const PointObservations& a, const PointObservations& b, const Visit& visit) {
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (i->point == j->point) visit(*i, *j);
    const std::size_t first = std::min(i->point, j->point);
    if (i->point == first) ++i;
    if (j != b.end() && j->point == first) ++j;
  }
}

}  // namespace dvi::exposure
