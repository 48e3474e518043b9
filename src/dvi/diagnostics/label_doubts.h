#pragma once

#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Says so where the LiDAR looks through the middle of labeled vehicles, as through those of another drive; empty where they
/// stop its rays, or are too few or too far to tell.
std::vector<std::string> label_doubts(const Drive& drive);

}  // namespace dvi::diagnostics
