#pragma once

#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"
#include "dvi/objects/detect/input.h"

namespace dvi::objects {

/// A box that a YOLO network proposes.
struct BoxCandidate {
  int type = 0;
  float score = 0;
  cv::Rect2d box;                   ///< in pixels of the input
  std::vector<float> coefficients;  ///< of the prototypes
};

/// The best of `count` classes whose values lie `step` apart; -1 where none is a number.
int best_class(const float* values, int count, std::ptrdiff_t step);

/// The candidates that no better one of their class suppresses, with their outlines. `prototypes`: 1 x M x h x w.
Detections with_masks(const std::vector<BoxCandidate>& candidates, const cv::Mat& prototypes, const Description& description,
                      const InputFit& fit);

/// An object of these pixels of a part of the image, its box tight; dropped if it has fewer than `least_pixels`.
void keep(Detections& detections, int type, float score, const cv::Mat1b& mask, cv::Point corner, int least_pixels);

/// Outputs of other shapes than the layout's: "expected" names those.
[[noreturn]] void refuse_shapes(const std::vector<cv::Mat>& outputs, const Description& description,
                                const std::string& expected);

Detections decode_semantic(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);
Detections decode_yolov5(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);
Detections decode_yolov8(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);

}  // namespace dvi::objects
