#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dvi::metrics {

/// Counts of points by their true label and by the label of a result. A point is dynamic if it has a class of moving objects
/// (is_moving_point_class()), else static.
struct PointCounts {
  std::size_t statics = 0;          ///< points that are static in truth
  std::size_t labeled_static = 0;   ///< those of them that the result labels as static
  std::size_t dynamics = 0;         ///< points that are dynamic in truth
  std::size_t labeled_dynamic = 0;  ///< those of them that the result labels as dynamic

  PointCounts& operator+=(const PointCounts& other);
  /// Return SA and DA, the shares of the static and of the dynamic points with the correct label, and AA, their geometric mean,
  /// as in the DynamicMap benchmark (Zhang et al., 2023). NaN without such points.
  double static_accuracy() const;
  double dynamic_accuracy() const;
  double associated_accuracy() const;
  /// Returns the intersection over union of the true and the labeled dynamic points. NaN if there are neither.
  double dynamic_iou() const;
};

/// The scores of the labels of all scans.
struct PointScores {
  std::size_t scans = 0;
  PointCounts all;
  PointCounts in_view;  ///< points in the image of the camera at the time of the nearest frame

  PointScores& operator+=(const PointScores& other);
};

/// Counts the points of one scan. All lists have one entry per point.
PointScores score_labels(const std::vector<std::uint32_t>& truth, const std::vector<std::uint32_t>& labels,
                         const std::vector<bool>& in_view);

}  // namespace dvi::metrics
