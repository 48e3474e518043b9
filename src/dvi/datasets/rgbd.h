#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "dvi/datasets/depth_scan.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"

namespace dvi::datasets {

/// Returns the rotation from the axes of scans of handheld RGB-D recordings (x forward, y left, z up, at the camera that their
/// poses are of) to those of a camera.
SE3 camera_from_level();

/// A file that is named by its number.
struct NumberedFile {
  int number = 0;
  std::string name;  ///< of the frame; the same for image, depth image and pose
  fs::path file;
};

/// Sets frames, scans and poses of a recording that numbers its images, depth images and 4x4 matrices world_from_camera. Each
/// list is in order of the numbers. A matrix with infinite entries gives no pose.
void set_numbered_files(Drive& drive, const std::vector<NumberedFile>& images, const std::vector<NumberedFile>& depths,
                        const std::vector<NumberedFile>& poses);

/// Sets the only camera of a layout. Throws InputError if `wanted` (--camera) is another one.
void name_camera(Drive& drive, const std::string& wanted, const char* name);

/// The camera whose poses a layout states.
enum class PosedCamera { color, depth };

/// Overrides the cameras by the drive's dvi.toml, if there is one; then sets camera_from_lidar, the sensor, and the reader of
/// the scans. `drive.camera` has to be set, except for its size.
void set_rgbd_cameras(DriveContents& recording, DepthCamera depth, PosedCamera posed);

/// Reads a text file with one 4x4 matrix. Returns nothing if its numbers are not finite, which means that tracking was lost.
/// Throws InputError if the file does not hold a 4x4 matrix.
std::optional<std::array<double, 16>> read_matrix(const fs::path& file);

/// Reads a 4x4 matrix as a rigid motion. Returns nothing if tracking was lost. Throws InputError if it is not a rigid motion.
std::optional<SE3> read_pose_matrix(const fs::path& file);

/// Finds the frames without a depth image within `within_ns` of their time.
Gap find_frames_without_depth(const Drive& drive, std::int64_t within_ns);

/// Finds the missing numbers between the first frame and the last one, if their names count every image.
Gap find_missing_numbers(Drive& drive);

}  // namespace dvi::datasets
