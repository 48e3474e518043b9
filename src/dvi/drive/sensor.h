#pragma once

namespace dvi {

/// The sensor that measured the scans.
enum class Sensor { lidar, depth_camera };

}  // namespace dvi
