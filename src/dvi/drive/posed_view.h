#pragma once

#include <cstddef>
#include <optional>

#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"

namespace dvi {

/// The view of a frame, by its index; none where the trajectory holds no pose for its time.
std::optional<View> posed_view(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar);

}  // namespace dvi
