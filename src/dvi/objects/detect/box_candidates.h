#pragma once

#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"
#include "dvi/objects/detect/input.h"

namespace dvi::objects {

/// A box that a YOLO network proposes.
struct BoxCandidate {
  int type = 0;  ///< index of its class
  float score = 0;
  cv::Rect2d box;                   ///< in pixels of the input
  std::vector<float> coefficients;  ///< per prototype
};

/// The pixels of an object in a part of the image.
struct DetectedPart {
  int type = 0;  ///< index of its class
  float score = 1;
  cv::Mat1b mask;    ///< of the part; 255 = object
  cv::Point corner;  ///< of the part in the image
};

/// Returns the index of the largest of `count` values that are `step` apart, or -1 if all are NaN or infinite.
int find_best_class(const float* values, int count, std::ptrdiff_t step);

/// Draws the masks of the candidates that no better candidate of their class suppresses. `prototypes` is 1 x M x h x w.
Detections draw_candidates(const std::vector<BoxCandidate>& candidates, const cv::Mat& prototypes,
                           const Description& description, const InputFit& fit);

/// Adds an object with a tight box. An object with fewer than `min_pixels` pixels is dropped.
void add_detection(Detections& detections, const DetectedPart& part, int min_pixels);

/// Throws InputError for outputs whose shapes do not fit the layout. `expected` describes the shapes that do.
[[noreturn]] void throw_unexpected_shapes(const std::vector<cv::Mat>& outputs, const Description& description,
                                          const std::string& expected);

/// Decode the outputs of one layout, as decode() does.
Detections decode_semantic(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);
Detections decode_yolov5(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);
Detections decode_yolov8(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);

}  // namespace dvi::objects
