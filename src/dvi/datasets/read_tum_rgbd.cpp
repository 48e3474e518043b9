#include <algorithm>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/pose_file.h"
#include "dvi/datasets/rgbd.h"
#include "dvi/labels/mask_folder.h"

namespace dvi::datasets {
namespace {

constexpr std::int64_t kImagePeriodNs = 33'333'333;

struct Stamped {
  std::int64_t time = 0;
  fs::path file;
};

// Reads lines "seconds file" of rgb.txt or depth.txt. The file names are relative to the drive.
std::vector<Stamped> read_list(Drive& drive, const char* name) {
  const fs::path list = drive.path / name;
  std::vector<Stamped> out;
  for (const TextLine& line : read_text_lines(list)) {
    if (line.size() != 2) line.fail("has " + std::to_string(line.size()) + " entries instead of 2", "lines are: seconds file");
    const fs::path relative = fs::path(line.word(1)).lexically_normal();
    if (relative.is_absolute() || relative.begin() == relative.end() || *relative.begin() == "..")
      line.fail("'" + line.word(1) + "' is not a file below the drive");
    out.push_back({line.nanoseconds(0), drive.path / relative});
    if (!fs::exists(out.back().file)) line.fail("refers to " + out.back().file.string() + ", which does not exist");
  }
  std::sort(out.begin(), out.end(), [](const Stamped& a, const Stamped& b) { return a.time < b.time; });
  drive.other_files.push_back(list);
  return out;
}

// Returns the comment in rgb.txt with the name of the recording ("# file: 'rgbd_dataset_freiburg1_rpy.bag'"), which remains if
// the folder is renamed; an empty text if there is none.
std::string find_original_name(const fs::path& drive) {
  for (const std::string& line : read_lines(drive / "rgb.txt"))
    if (line.starts_with('#') && line.find("freiburg") != std::string::npos) return line;
  return {};
}

// Returns the camera that the benchmark recommends. The depth is registered to the images by the driver's default camera,
// except for the third Kinect, whose images are rectified.
Camera choose_camera_model(const Drive& drive, std::vector<std::string>& warnings) {
  const std::string name = to_lower_case(drive.path.filename().string() + " " + find_original_name(drive.path));
  if (name.find("freiburg3") != std::string::npos) return {.fx = 535.4, .fy = 539.2, .cx = 320.1, .cy = 247.6};
  if (name.find("freiburg") == std::string::npos && !fs::exists(drive.path / "dvi.toml"))
    warnings.emplace_back(
        "the camera is unknown: fx = fy = 525, cx = 319.5, cy = 239.5 are assumed; set [camera.rgb] K in dvi.toml "
        "if they are wrong");
  return {.fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
}

// Reads groundtruth.txt, which has the poses of the color camera.
Trajectory read_ground_truth(Drive& drive) {
  const fs::path file = drive.path / "groundtruth.txt";
  if (!fs::exists(file)) return {};
  drive.other_files.push_back(file);
  const Trajectory world_from_camera = read_poses(file, drive);
  std::vector<StampedPose> poses = world_from_camera.poses();
  for (StampedPose& pose : poses) pose.world_from_body = pose.world_from_body * camera_from_level();
  return Trajectory(std::move(poses));
}

DriveContents read_tum_rgbd(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  name_camera(drive, options.camera, "rgb");
  for (const Stamped& image : read_list(drive, "rgb.txt"))
    drive.frames.push_back({static_cast<int>(drive.frames.size()), image.file.stem().string(), image.time, image.file, {}});
  for (const Stamped& depth : read_list(drive, "depth.txt"))
    drive.scan_headers.push_back(
        {depth.file.stem().string(), depth.time, depth.time - kImagePeriodNs / 2, depth.time + kImagePeriodNs / 2, depth.file});
  drive.poses = read_ground_truth(drive);
  labels::match_masks(drive, {path / "masks"});
  recording.gaps = {find_frames_without_depth(drive, kImagePeriodNs)};
  drive.camera = choose_camera_model(drive, drive.warnings);
  set_rgbd_cameras(recording, {.units_per_meter = 5000}, PosedCamera::color);
  return recording;
}

bool recognize_tum_rgbd(const fs::path& path) { return fs::exists(path / "rgb.txt") && fs::exists(path / "depth.txt"); }

}  // namespace

DriveFormat tum_rgbd_format() {
  return {"tum-rgbd",
          "rgb.txt and depth.txt, the images they list, groundtruth.txt",
          recognize_tum_rgbd,
          read_tum_rgbd,
          {"rgb", "depth", "rgb.txt", "depth.txt"}};
}

}  // namespace dvi::datasets
