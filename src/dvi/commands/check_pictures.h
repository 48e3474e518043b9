#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::commands {

/// Draws the returns of the scan nearest in time to a frame on its image, from red (near) to blue (far). If they are not
/// aligned with the edges of objects, the calibration, the clocks, or the poses are wrong. Returns BGR; the image alone if the
/// frame has no pose or there is no scan.
cv::Mat3b draw_lidar_on_image(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar);

/// Draws the returns of the drive from above, colored by their height above the path, the path with a green start and a red
/// end, and a scale bar of 10 m. Returns BGR; empty if there are no poses.
cv::Mat3b draw_birds_view(const Drive& drive, const Trajectory& world_from_lidar);

/// Writes lidar_on_image_NAME.png for three frames, evenly spread, and birds_view.png. Returns the paths of the files.
std::vector<std::string> write_check_pictures(const fs::path& folder, const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::commands
