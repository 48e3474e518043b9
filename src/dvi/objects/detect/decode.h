#pragma once

#include "dvi/objects/detect/description.h"
#include "dvi/objects/detect/detection.h"
#include "dvi/objects/detect/input.h"

namespace dvi::objects {

/// What a network's outputs (float) say of the image that was fitted into its input: objects of the classes that are removed.
/// For C classes, as the layout says; h, w: any resolution, which covers the whole input.
///
/// semantic: 1 x C x h x w, of which the largest counts; or 1 x 1 x h x w, 1 x h x w or h x w, the class of each pixel. An
/// object is a 4-connected part of a class.
///
/// yolov5_seg: 1 x N x (5 + C + M): center, width and height in pixels of the input, objectness, classes, coefficients; and
/// 1 x M x h x w prototypes, whose sum weighted by the coefficients is positive inside the object.
///
/// yolov8_seg: its head before the boxes are decoded. For each stride s either 1 x 64 x H/s x W/s (four distances to the sides
/// of the box, 16 logits each) and 1 x C x H/s x W/s (logits of the classes), or one 1 x (64 + C) x H/s x W/s of both; and 1 x
/// M x H/s x W/s coefficients. And 1 x M x h x w prototypes at a resolution of their own.
///
/// InputError where the outputs have other shapes: what they have, and what is expected.
Detections decode(const std::vector<cv::Mat>& outputs, const Description& description, const InputFit& fit);

}  // namespace dvi::objects
