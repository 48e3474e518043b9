#pragma once

#include <string>
#include <vector>

#include "dvi/bags/bag_messages.h"
#include "dvi/bags/bag_topics.h"
#include "dvi/geometry/camera.h"

namespace dvi::bags {

/// The camera that the first CameraInfo of a topic describes; the rectified camera where the name of the topic of images says
/// that they are rectified ("image_rect"). Where it has no image size, the first image has. Warns where the calibration seems
/// to be that of another camera. InputError where it was never calibrated, and where its distortion model is not supported.
Camera read_bag_camera(const BagMessages& messages, const BagCamera& camera, std::vector<std::string>& warnings);

}  // namespace dvi::bags
