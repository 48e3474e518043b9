#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::commands {

/// The returns of the scan nearest to a frame, drawn on its image, from red (near) to blue (far): if they do not lie on the
/// edges of things, calibration, clocks or poses are off. BGR; the plain image where a pose or scan is missing.
cv::Mat3b lidar_on_image(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar);

/// The returns of the drive from above, colored by their height over the path, and the path, its begin green, its end red; a
/// bar of 10 m. BGR; empty where there are no poses.
cv::Mat3b birds_view(const Drive& drive, const Trajectory& world_from_lidar);

/// Writes lidar_on_image_NAME.png for three frames, evenly spread, and birds_view.png; returns the files.
std::vector<std::string> write_check_pictures(const fs::path& folder, const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::commands
