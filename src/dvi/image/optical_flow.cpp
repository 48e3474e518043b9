#include "dvi/image/optical_flow.h"

#include <opencv2/video/tracking.hpp>

namespace dvi {

cv::Mat2f compute_optical_flow(const cv::Mat1b& from, const cv::Mat1b& to, FlowPreset preset) {
  cv::Mat2f flow;
  cv::DISOpticalFlow::create(preset == FlowPreset::fast ? cv::DISOpticalFlow::PRESET_FAST : cv::DISOpticalFlow::PRESET_MEDIUM)
      ->calc(from, to, flow);
  return flow;
}

}  // namespace dvi
