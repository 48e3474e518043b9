#include <map>
#include <optional>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/kitti_calibration.h"
#include "dvi/datasets/kitti_files.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/scan_files.h"
#include "dvi/geometry/plausible.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

constexpr std::int64_t kHalfScanNs = 50'000'000;  // at 10 Hz

NumberedFiles list_sequence_images(const fs::path& path, const std::string& camera) {
  return list_numbered_files(path / camera, kImageEndings);
}

// Returns the line of a number. times.txt and the poses have a line for each number of the whole sequence, also for an excerpt.
const TextLine& find_line(const std::vector<TextLine>& lines, int number, const fs::path& file, const fs::path& data) {
  if (static_cast<std::size_t>(number) < lines.size()) return lines[static_cast<std::size_t>(number)];
  throw InputError(file, "ends before line " + std::to_string(number + 1) + ", the line of " + data.filename().string(),
                   "use the file of the whole sequence, as published by KITTI");
}

// Finds the poses in the sequence, as in SemanticKITTI, or in the folder of the benchmark.
std::optional<fs::path> find_poses_file(const fs::path& path) {
  const fs::path benchmark = path.parent_path().parent_path() / "poses" / (path.filename().string() + ".txt");
  for (const fs::path& file : {path / "poses.txt", benchmark})
    if (fs::exists(file)) return file;
  return std::nullopt;
}

// Reads the poses of the rectified camera 0, which are relative to its first axes, and turns the world upright like the LiDAR.
Trajectory read_poses_of_camera_0(const fs::path& file, const Drive& drive, const SE3& rect0_from_lidar) {
  const std::vector<TextLine> lines = read_text_lines(file);
  std::vector<StampedPose> poses;
  for (const Frame& frame : drive.frames) {
    const TextLine& line = find_line(lines, frame.number, file, frame.file);
    const auto numbers = line.numbers<12>(0);
    const std::optional<SE3> world_from_rect0 = to_rigid(numbers);
    if (!world_from_rect0)
      line.fail(describe_rotation_problem(get_left_part(numbers)), "a pose is a 3x4 matrix, row by row, each row r r r t");
    poses.push_back({frame.time_ns, rect0_from_lidar.inverse() * *world_from_rect0 * rect0_from_lidar});
  }
  return Trajectory(std::move(poses));
}

DriveContents read_kitti_odometry(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  for (const char* camera : {"image_0", "image_1", "image_2", "image_3"})
    if (!list_sequence_images(path, camera).empty()) drive.camera_names.emplace_back(camera);
  if (drive.camera_names.empty())
    fail_without_images(fs::is_directory(path / "image_2") ? path / "image_2" : path / "image_0", "holds no images",
                        "put them into image_2 (color) or image_0 (gray), named by their numbers");
  const bool number = is_all_digits(options.camera) && options.camera.size() == 1;
  drive.camera_name = choose_camera(drive, number ? "image_" + options.camera : options.camera, "image_2");

  const KittiCalibration calibration = read_kitti_odometry_calibration(path / "calib.txt", drive.camera_name);
  drive.camera = calibration.camera;
  drive.camera_from_lidar = calibration.camera_from_lidar();
  const fs::path times = path / "times.txt";
  const std::vector<TextLine> stamps = read_text_lines(times);
  drive.other_files = {path / "calib.txt", times};
  const NumberedFiles images = list_sequence_images(path, drive.camera_name),
                      scans = list_numbered_files(path / "velodyne", {".bin"});
  const auto time_of = [&](int n, const fs::path& data) { return find_line(stamps, n, times, data).nanoseconds(0); };
  for (const auto& [n, file] : images) drive.frames.push_back({n, file.stem().string(), time_of(n, file), file, {}});
  for (const auto& [n, file] : scans) {
    const std::int64_t time = time_of(n, file);
    drive.scan_headers.push_back({file.stem().string(), time, time - kHalfScanNs, time + kHalfScanNs, file});
  }
  const cv::Size size = media::image_size(drive.frames.front().file);
  drive.camera.width = size.width, drive.camera.height = size.height;
  require_plausible(drive.camera, path / "calib.txt", "P" + drive.camera_name.substr(6));
  if (const auto poses = find_poses_file(path)) {
    drive.poses = read_poses_of_camera_0(*poses, drive, calibration.rect0_from_lidar);
    drive.other_files.push_back(*poses);
  }
  recording.gaps = find_kitti_gaps(drive, images, scans, options);
  Rotation rotation{.turn = Turn::none};  // the benchmark's scans are compensated for the motion
  LidarConfig lidar;
  if (const auto config = read_drive_config(path)) {
    config->apply(drive);
    lidar = config->lidar;
    rotation.turn = lidar.turn.value_or(Turn::none);
    rotation.first_azimuth = lidar.rotation().first_azimuth;
  }
  attach_scan_files(recording, lidar, rotation);
  return recording;
}

bool recognize_kitti_odometry(const fs::path& path) {
  const bool images = fs::is_directory(path / "image_2") || fs::is_directory(path / "image_0");
  return images && fs::exists(path / "calib.txt") && fs::exists(path / "times.txt");
}

}  // namespace

DriveFormat kitti_odometry_format() {
  return {"kitti-odometry",
          "sequences/00 with image_2 (or image_0), velodyne, calib.txt and times.txt",
          recognize_kitti_odometry,
          read_kitti_odometry,
          {"image_2|image_0", "velodyne", "calib.txt", "times.txt"},
          2};
}

}  // namespace dvi::datasets
