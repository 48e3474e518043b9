#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/visible_points.h"

namespace dvi::exposure {

/// What a view shows of a point of the map.
struct PointObservation {
  std::size_t point = 0;
  cv::Vec3f color;     ///< its logarithm
  float off_axis = 0;  ///< as compute_off_axis()
};

using Sightings = std::vector<PointObservation>;

/// What a view shows of the map, unmasked, neither black nor saturated, in order of points.
Sightings sightings(const View& view, const std::vector<map::VisiblePoint>& points, const cv::Mat3b& image,
                    const cv::Mat1b& mask);

/// Calls `with` with both sightings of each point that both views show.
template <class With>
void for_each_shared(const Sightings& a, const Sightings& b, const With& with) {
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (i->point == j->point) with(*i, *j);
    const std::size_t first = std::min(i->point, j->point);
    if (i->point == first) ++i;
    if (j != b.end() && j->point == first) ++j;
  }
}

}  // namespace dvi::exposure
