#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/exports/map_cloud.h"

namespace dvi::exports {

/// The height of the ground on a grid seen from above.
struct GroundRaster {
  double cell_m = 0;
  double west_m = 0, north_m = 0;  ///< world x and y of the corner of cell (0, 0); columns go along x, rows against y
  cv::Mat1f height;                ///< in meters at the center of each cell; NaN: unknown

  Eigen::Vector3d middle(int row, int column) const {
    return {west_m + (column + 0.5) * cell_m, north_m - (row + 0.5) * cell_m, double{height(row, column)}};
  }
};

/// Computes the ground below a static map: the lowest points of each square of a meter, and the points up to a curb's height
/// above them. Cells without a point get the mean of their neighbors, up to 0.5 m away. Throws UsageError if the grid would
/// exceed 2^26 cells. `cloud` must not be empty.
GroundRaster ground_of(const std::vector<CloudPoint>& cloud, double cell_m);

}  // namespace dvi::exports
