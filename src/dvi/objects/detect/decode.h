#pragma once

#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"
#include "dvi/objects/detect/input.h"

namespace dvi::objects {

/// Decodes the outputs (float) of a network into the objects of the removed classes, in the image that was fitted into its
/// input. The layout defines the shapes, with C classes; h and w are any resolution, and the maps cover the whole input.
///
/// semantic: 1 x C x h x w, whose largest channel is the class of a pixel; or 1 x 1 x h x w, 1 x h x w, or h x w, which is the
/// class of each pixel. An object is a 4-connected part of a class.
///
/// yolov5_seg: 1 x N x (5 + C + M) with center, width, and height in pixels of the input, objectness, classes, and
/// coefficients; and 1 x M x h x w prototypes, whose sum, weighted by the coefficients, is positive inside the object.
///
/// yolov8_seg: the head before the boxes are decoded. For each stride s either 1 x 64 x H/s x W/s (four distances to the sides
/// of the box, with 16 logits each) and 1 x C x H/s x W/s (logits of the classes), or one 1 x (64 + C) x H/s x W/s of both; and
/// 1 x M x H/s x W/s coefficients. Also 1 x M x h x w prototypes at a resolution of their own.
///
/// Throws InputError, with the actual and the expected shapes, if the outputs have other shapes.
Detections decode(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);

}  // namespace dvi::objects
