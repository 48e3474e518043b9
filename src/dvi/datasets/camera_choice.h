#pragma once

#include <string>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// Returns `asked` if it is given, else `usual` if the drive has that camera, else the drive's first camera. Throws InputError
/// if the drive does not have the camera `asked`.
std::string choose_camera(const Drive& drive, const std::string& asked, const std::string& usual);

}  // namespace dvi::datasets
