#pragma once

#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"
#include "dvi/objects/detect/input.h"
#include "dvi/objects/detect/tensor.h"

namespace dvi::objects {

/// Decodes the outputs of a network into the objects of the removed classes, in the image that was fitted into its input. The
/// layout defines the shapes, with C classes, M coefficients, and N boxes; h and w are any resolution, and the maps cover the
/// whole input. A mask is the part of the box in which the sum of 1 x M x h x w prototypes, weighted by the coefficients, is
/// positive. Without prototypes, M is 0, and the object is its box.
///
/// semantic: 1 x C x h x w, whose largest channel is the class of a pixel; or 1 x 1 x h x w, 1 x h x w, or h x w, which is the
/// class of each pixel. An object is a 4-connected part of a class.
///
/// yolov5 (also YOLOv7): 1 x N x (5 + C + M) with center, width, and height in pixels of the input, objectness, classes, and
/// coefficients.
///
/// yolov8 (also YOLOv9, 11, 12, and 26 without its end-to-end head): 1 x (4 + C + M) x N with center, width, and height in
/// pixels of the input, classes, and coefficients. Or the head before the boxes are decoded: for each stride s either 1 x 4B x
/// H/s x W/s (four distances to the sides of the box, with B logits each, or the distances themselves if B is 1) and 1 x C x
/// H/s x W/s (logits of the classes), or one 1 x (4B + C) x H/s x W/s of both; and with prototypes 1 x M x H/s x W/s
/// coefficients. B is 16 or 1.
///
/// nms (YOLO with non-maximum suppression inside, YOLOv10, YOLO26): 1 x N x (6 + M) with left, top, right, and bottom in pixels
/// of the input or as shares of it, score, class, and coefficients; or N x 7 with the number of the image first.
///
/// detr (DETR, RT-DETR): 1 x N x C or 1 x N x (C + 1) logits (the last one of no object) and 1 x N x 4 boxes; or
/// 1 x N x (4 + C) with boxes and scores. Boxes have center, width, and height as shares of the input.
///
/// rcnn (Mask R-CNN, Faster R-CNN, RT-DETR with its postprocessor): N x 4 boxes with left, top, right, and bottom in pixels of
/// the input, N whole numbers that are classes, and N scores; and N x 1 x h x w probabilities, of the box if they are smaller
/// than the input, else of the input. All may have a first axis of size 1.
///
/// Throws InputError, with the actual and the expected shapes, if the outputs have other shapes.
Detections decode(const std::vector<Tensor>& outputs, const Description& description, const InputFit& fit);

/// Recognizes the layout of outputs. Throws InputError, with their names and shapes, if it is none of the above.
Layout recognize_layout(const std::vector<Tensor>& outputs, const Description& description);

}  // namespace dvi::objects
