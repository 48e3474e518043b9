#pragma once

#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"
#include "dvi/objects/detect/input.h"
#include "dvi/objects/detect/tensor.h"

namespace dvi::objects {

/// A box that a network proposes.
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
  cv::Mat1b mask;       ///< of the part; 255 = object
  cv::Point corner;     ///< of the part in the image
  bool is_box = false;  ///< whether the mask is a box
};

/// Returns the index of the largest of `count` values that are `step` apart, or -1 if all are NaN or infinite.
int find_best_class(const float* values, int count, std::ptrdiff_t step);

/// Returns whether a candidate has a finite box with an area, a removed class, and a sufficient score.
bool is_usable(const BoxCandidate& candidate, const Description& description);

/// Returns the pixels of the image that a box in the input touches.
cv::Rect to_image_pixels(const cv::Rect2d& box, const InputFit& fit);

/// Returns the candidates that no better candidate of their class suppresses.
std::vector<BoxCandidate> suppress_non_maxima(const std::vector<BoxCandidate>& candidates, const Description& description,
                                              const InputFit& fit);

/// Draws the masks of the candidates. `prototypes` is 1 x M x h x w; null: the masks are the boxes.
Detections draw_candidates(const std::vector<BoxCandidate>& candidates, const Tensor* prototypes,
                           const Description& description, const InputFit& fit);

/// Adds an object with a tight box. An object with fewer than `min_pixels` pixels is dropped.
void add_detection(Detections& detections, const DetectedPart& part, int min_pixels);

/// Returns the only output of 1 x M x h x w, or null if there is none, or more than one.
const Tensor* find_only_map(const std::vector<Tensor>& outputs);

/// Returns the rows of the only output of 1 x N x M or N x M, or null.
const Tensor* find_only_rows(const std::vector<Tensor>& outputs);

/// Returns whether the outputs are the maps of YOLOv8's head before its boxes are decoded.
bool is_undecoded_yolov8(const std::vector<Tensor>& outputs, const Description& description);

/// Returns whether a map is the class of each pixel: whole numbers from 0 on.
bool is_class_map(const Tensor& tensor);

/// The outputs of R-CNN; `masks` is null for networks without masks.
struct RcnnOutputs {
  const Tensor *boxes = nullptr, *labels = nullptr, *scores = nullptr, *masks = nullptr;
};
/// Finds them by their shapes, and the labels by being whole numbers. Returns null pointers for boxes if there are none.
RcnnOutputs find_rcnn_outputs(const std::vector<Tensor>& outputs);

/// The outputs of DETR.
struct DetrOutputs {
  const Tensor *logits = nullptr, *boxes = nullptr;
};
/// Finds them by their shapes. Returns null pointers if there are none.
DetrOutputs find_detr_outputs(const std::vector<Tensor>& outputs, int classes);

/// Throws InputError for outputs whose shapes do not fit the layout. `expected` describes the shapes that do.
[[noreturn]] void throw_unexpected_shapes(const std::vector<Tensor>& outputs, const Description& description,
                                          const std::string& expected);

/// Decode the outputs of one layout, as decode() does.
Detections decode_semantic(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);
Detections decode_yolov5(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);
Detections decode_yolov8(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);
Detections decode_nms(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);
Detections decode_detr(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);
Detections decode_rcnn(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);

}  // namespace dvi::objects
