#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "dvi/datasets/depth_scan.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"

namespace dvi::datasets {

/// What the layouts of handheld RGB-D recordings have in common. Their scans are in axes x forward, y left, z up at the place
/// of the camera that their poses are of.
SE3 camera_from_level();

struct NumberedFile {
  int number = 0;
  std::string name;  ///< of the frame, the same for image, depth and pose
  fs::path file;
};

/// Sets frames, scans and poses of a recording that numbers its images, depth images and 4x4 matrices world_from_camera, each
/// in order of their numbers. What has no finite matrix has no pose.
void set_numbered_files(Drive& drive, const std::vector<NumberedFile>& images, const std::vector<NumberedFile>& depths,
                        const std::vector<NumberedFile>& poses);

/// The one camera of the layout, which --camera may name.
void name_camera(Drive& drive, const std::string& wanted, const char* name);

/// Whose poses a layout gives.
enum class PosedCamera { color, depth };

/// Overrides the cameras by the drive's dvi.toml, if there is one; then sets camera_from_lidar, the sensor, and what reads its
/// scans. `drive.camera` is set, but for its size.
void set_rgbd_cameras(DriveContents& recording, DepthCamera depth, PosedCamera posed);

/// A 4x4 matrix in a text file of its own; none where its numbers are not finite, as tracking writes them where it was lost.
/// InputError where the file holds something else.
std::optional<std::array<double, 16>> read_matrix(const fs::path& file);

/// The motion that a 4x4 matrix is; none where it was lost. InputError where it is none.
std::optional<SE3> read_pose_matrix(const fs::path& file);

/// Frames without a depth image within `within_ns` of their time.
Gap frames_without_depth(const Drive& drive, std::int64_t within_ns);

/// Numbers missing between the first frame and the last, if their names count every image.
Gap missing_numbers(Drive& drive);

}  // namespace dvi::datasets
