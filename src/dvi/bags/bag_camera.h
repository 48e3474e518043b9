#pragma once

#include <string>
#include <vector>

#include "dvi/bags/bag_messages.h"
#include "dvi/bags/bag_topics.h"
#include "dvi/geometry/camera.h"

namespace dvi::bags {

/// Reads the camera of the first CameraInfo of a topic, or the rectified camera if the name of the image topic states rectified
/// images ("image_rect"). If the calibration has no image size, uses that of the first image. Adds a warning if the calibration
/// seems to be of another camera. Throws InputError if the camera was never calibrated or if its distortion model is not
/// supported.
Camera read_bag_camera(const BagMessages& messages, const BagCamera& camera, std::vector<std::string>& warnings);

}  // namespace dvi::bags
