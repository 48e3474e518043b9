#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"
#include "dvi/drive/view.h"
#include "dvi/map/visible_points.h"

namespace dvi::align {

/// The views [first, last) of one sequence, with what they see of the map.
struct SequenceViews {
  const Views& views;
  const map::VisibleMap& map;
  std::size_t first = 0, last = 0;
};

/// What a view sees of the map, outside its mask.
class UnmaskedPoints {
 public:
  UnmaskedPoints(const std::vector<map::VisiblePoint>& visible, const cv::Mat1b& mask);

  /// In raster order.
  const std::vector<map::VisiblePoint>& points() const { return points_; }
  /// Within the mask or a few pixels round it.
  bool masked(const cv::Point& pixel) const { return masked_(pixel) != 0; }
  /// Whether the view shows a surface of depth z at this pixel (inside the image): not masked, nothing nearer before it.
  bool shows(const Eigen::Vector2d& pixel, double z) const;
  /// Whether something clearly nearer lies within a few pixels: the edge seen there may be that thing's.
  bool beside_nearer(const map::VisiblePoint& point) const;
  std::size_t bytes() const { return bytes_of(masked_) + bytes_of(nearest_) + bytes_of(points_); }

 private:
  cv::Mat1b masked_;
  cv::Mat1f nearest_;  // depth, at a part of the image's size
  std::vector<map::VisiblePoint> points_;
};

}  // namespace dvi::align
