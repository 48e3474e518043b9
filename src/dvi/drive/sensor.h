#pragma once

namespace dvi {

/// What measured the scans.
enum class Sensor { lidar, depth_camera };

}  // namespace dvi
