#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/geometry/camera.h"

namespace dvi::objects {

/// Returns the pixels of the surfaces that returns lie on, 255, from the pixels of the returns (255): closes the gaps between
/// the rays of a LiDAR with rows up to 0.85 degrees apart. Leaves out single returns and rows, which may be errors.
cv::Mat1b close_returns(const cv::Mat1b& returns, const Camera& camera);

}  // namespace dvi::objects
