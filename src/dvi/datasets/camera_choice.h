#pragma once

#include <string>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The camera asked for; where none is, `usual` if the drive has it, else its first. InputError where the drive does not
/// have the one asked for.
std::string choose_camera(const Drive& drive, const std::string& asked, const std::string& usual);

}  // namespace dvi::datasets
