#include "dvi/image/gray.h"

#include <opencv2/imgproc.hpp>

namespace dvi {

cv::Mat1b gray_8bit(const cv::Mat3b& image) {
  cv::Mat1b out;
  cv::cvtColor(image, out, cv::COLOR_BGR2GRAY);
  return out;
}

}  // namespace dvi
