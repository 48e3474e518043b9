#include <map>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/rgbd.h"
#include "dvi/labels/mask_folder.h"

namespace dvi::datasets {
namespace {

// Lists the files N.ENDING in order of their numbers, which have no leading zeros.
std::vector<NumberedFile> list_files_by_number(const fs::path& folder, const std::vector<std::string>& endings) {
  std::map<int, fs::path> by_number;
  for (const fs::path& file : list_files(folder, endings)) {
    const auto number = to_integer(file.stem().string());
    if (!number || *number < 0) throw InputError(file, "is not named by its number", "name the files 0.jpg, 1.jpg, ...");
    if (!by_number.emplace(*number, file).second)
      throw InputError(file, "has the number of " + by_number.at(*number).string(), "remove one of them");
  }
  std::vector<NumberedFile> out;
  for (const auto& [number, file] : by_number) out.push_back({number, file.stem().string(), file});
  return out;
}

Camera read_intrinsic(const fs::path& path, const char* name, Drive& drive) {
  const fs::path file = path / "intrinsic" / name;
  if (!fs::exists(file)) throw InputError(file, "is missing", "export it by SensReader with --export_intrinsics");
  const auto K = read_matrix(file);
  if (!K) throw InputError(file, "holds numbers that are not finite");
  drive.other_files.push_back(file);
  return {.fx = (*K)[0], .fy = (*K)[5], .cx = (*K)[2], .cy = (*K)[6]};
}

// Reads rig_from_camera; the identity if there is no such file.
SE3 read_extrinsic(const fs::path& path, const char* name, Drive& drive) {
  const fs::path file = path / "intrinsic" / name;
  if (!fs::exists(file)) return {};
  const auto pose = read_pose_matrix(file);
  if (!pose) throw InputError(file, "holds numbers that are not finite");
  drive.other_files.push_back(file);
  return *pose;
}

// Reads the depth camera. Its images differ in size from the color images. If the recording was calibrated, both cameras are at
// the same position and both extrinsics are the identity.
DepthCamera read_depth_camera(const fs::path& path, Drive& drive) {
  DepthCamera depth{.camera = read_intrinsic(path, "intrinsic_depth.txt", drive)};
  const SE3 rig_from_color = read_extrinsic(path, "extrinsic_color.txt", drive);
  const SE3 depth_from_color = read_extrinsic(path, "extrinsic_depth.txt", drive).inverse() * rig_from_color;
  constexpr double kMaxIdentityDeviation = 1e-6;
  if (depth_from_color.t.norm() > kMaxIdentityDeviation || so3_log(depth_from_color.R).norm() > kMaxIdentityDeviation)
    depth.depth_from_color = depth_from_color;
  return depth;
}

DriveContents read_scannet(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  name_camera(drive, options.camera, "color");
  set_numbered_files(drive, list_files_by_number(path / "color", kImageEndings), list_files_by_number(path / "depth", {".png"}),
                     list_files_by_number(path / "pose", {".txt"}));
  labels::match_masks(drive, {path / "masks"});
  recording.gaps = {find_frames_without_depth(drive, 0)};
  drive.camera = read_intrinsic(path, "intrinsic_color.txt", drive);
  set_rgbd_cameras(recording, read_depth_camera(path, drive), PosedCamera::depth);
  return recording;
}

bool recognize_scannet(const fs::path& path) {
  return fs::is_directory(path / "color") && fs::is_directory(path / "depth") && fs::is_directory(path / "intrinsic");
}

}  // namespace

DriveFormat scannet_format() {
  return {"scannet",
          "color/N.jpg, depth/N.png, pose/N.txt and intrinsic/ beside each other, as SensReader exports them",
          recognize_scannet,
          read_scannet,
          {"color", "depth", "intrinsic", "pose"}};
}

}  // namespace dvi::datasets
