#pragma once

#include <map>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/label.h"

namespace dvi::labels {

/// Returns the outline of each value other than 0 in an image of the numbers of objects.
std::map<int, Instance> outline_ids(const cv::Mat1i& ids);

}  // namespace dvi::labels
