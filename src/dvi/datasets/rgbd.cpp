#include "dvi/datasets/rgbd.h"

#include <algorithm>
#include <cmath>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/geometry/plausible.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

bool not_finite(const std::string& word) {
  const std::string lower = to_lower_case(word);  // Windows writes -1.#INF
  return lower.find("inf") != std::string::npos || lower.find("nan") != std::string::npos ||
         lower.find("#ind") != std::string::npos;
}

constexpr double kFrameRateHz = 30;  // if there are no times but only numbers

void set_size(Camera& camera, const fs::path& image) {
  const cv::Size size = media::image_size(image);
  camera.width = size.width, camera.height = size.height;
}

// Throws InputError if the nominal camera of the layout does not match the size of the images, and the user stated no K.
void require_centered(const Camera& camera, const fs::path& image, const std::string& table) {
  if (const std::string problem = describe_off_center_problem(camera); !problem.empty())
    throw InputError(image, problem, "set K of these images in the table [" + table + "] of dvi.toml");
}

std::int64_t to_time_ns(const NumberedFile& file) { return std::llround(1e9 * file.number / kFrameRateHz); }

}  // namespace

SE3 camera_from_level() { return {(Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished(), {0, 0, 0}}; }

void set_numbered_files(Drive& drive, const std::vector<NumberedFile>& images, const std::vector<NumberedFile>& depths,
                        const std::vector<NumberedFile>& poses) {
  for (const NumberedFile& image : images)
    drive.frames.push_back({image.number, image.name, to_time_ns(image), image.file, {}});
  for (const NumberedFile& depth : depths)
    drive.scan_headers.push_back({depth.name, to_time_ns(depth), to_time_ns(depth), to_time_ns(depth), depth.file});
  std::vector<StampedPose> stamped;
  for (const NumberedFile& pose : poses) {
    drive.other_files.push_back(pose.file);
    if (const auto world_from_camera = read_pose_matrix(pose.file))
      stamped.push_back({to_time_ns(pose), *world_from_camera * camera_from_level()});
  }
  drive.poses = Trajectory(std::move(stamped));
}

void name_camera(Drive& drive, const std::string& wanted, const char* name) {
  drive.camera_names = {name};
  drive.camera_name = choose_camera(drive, wanted, name);
}

void set_rgbd_cameras(DriveContents& recording, DepthCamera depth, PosedCamera posed) {
  Drive& drive = recording.drive;
  const std::optional<DriveConfig> config = read_drive_config(drive.path);
  if (!drive.frames.empty()) {
    const fs::path& file = drive.frames.front().file;
    set_size(drive.camera, file);
    const bool given = config && config->camera(drive.camera_name).K;
    if (!given) require_centered(drive.camera, file, "camera." + drive.camera_name);
  }
  if (config) config->depth.apply(depth);
  drive.camera_from_lidar = camera_from_level();
  if (posed == PosedCamera::depth && depth.depth_from_color)
    drive.camera_from_lidar = depth.depth_from_color->inverse() * camera_from_level();
  if (config) config->apply(drive);
  recording.read_scan = attach_depth_camera(drive, depth);
  if (depth.camera && !drive.scan_headers.empty() && !(config && config->depth.K))
    require_centered(drive.depth_images->camera, drive.scan_headers.front().file, "depth");
}

std::optional<std::array<double, 16>> read_matrix(const fs::path& file) {
  const std::vector<TextLine> lines = read_text_lines(file);
  std::array<double, 16> out{};
  bool lost = false;
  if (lines.size() != 4)
    throw InputError(file, "has " + std::to_string(lines.size()) + " lines instead of 4", "write a 4x4 matrix");
  for (std::size_t row = 0; row < 4; ++row) {
    if (lines[row].size() != 4) lines[row].fail("has " + std::to_string(lines[row].size()) + " entries instead of 4");
    for (std::size_t column = 0; column < 4; ++column) {
      if (not_finite(lines[row].word(column)))
        lost = true;
      else
        out[4 * row + column] = lines[row].number(column);
    }
  }
  if (lost) return std::nullopt;
  return out;
}

std::optional<SE3> read_pose_matrix(const fs::path& file) {
  const auto matrix = read_matrix(file);
  if (!matrix) return std::nullopt;
  std::array<double, 12> rows{};
  std::copy_n(matrix->begin(), rows.size(), rows.begin());
  if (const auto pose = to_rigid(rows)) return pose;
  throw InputError(file, describe_rotation_problem(get_left_part(rows)), "write a 4x4 matrix, camera to world");
}

Gap find_frames_without_depth(const Drive& drive, std::int64_t within_ns) {
  Gap gap{"no depth image for frames", {}};
  for (const Frame& frame : drive.frames)
    if (!nearest_in_time(drive.scan_headers, frame.time_ns, within_ns)) gap.frames.push_back(frame.number);
  return gap;
}

Gap find_missing_numbers(Drive& drive) {
  Gap gap{"no image for frames", {}};
  if (can_list_numbers(drive, 1))
    for (std::size_t i = 1; i < drive.frames.size(); ++i)
      for (int number = drive.frames[i - 1].number + 1; number < drive.frames[i].number; ++number) gap.frames.push_back(number);
  return gap;
}

}  // namespace dvi::datasets
