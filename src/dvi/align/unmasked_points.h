#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"
#include "dvi/drive/view.h"
#include "dvi/map/visible_points.h"

namespace dvi::align {

/// The views [first, last) of one sequence, with their visible map points.
struct SequenceViews {
  const Views& views;
  const map::VisibleMap& map;
  std::size_t first = 0, last = 0;
};

/// The map points that are visible in a view outside its mask.
class UnmaskedPoints {
 public:
  UnmaskedPoints(const std::vector<map::VisiblePoint>& visible, const cv::Mat1b& mask);

  /// Returns the points in raster order.
  const std::vector<map::VisiblePoint>& points() const { return points_; }
  /// Returns whether the pixel is in the mask or within a few pixels of it.
  bool is_masked(const cv::Point& pixel) const { return masked_(pixel) != 0; }
  /// Returns whether the view shows a surface of depth z at this pixel, which must be within the image: it is not masked, and
  /// no surface is nearer.
  bool is_visible(const Eigen::Vector2d& pixel, double z) const;
  /// Returns whether a clearly nearer surface is within a few pixels, so that texture there may be its edge.
  bool is_near_edge(const map::VisiblePoint& point) const;
  std::size_t bytes() const { return bytes_of(masked_) + bytes_of(nearest_) + bytes_of(points_); }

 private:
  cv::Mat1b masked_;
  cv::Mat1f nearest_;  // smallest depth, at reduced size
  std::vector<map::VisiblePoint> points_;
};

}  // namespace dvi::align
