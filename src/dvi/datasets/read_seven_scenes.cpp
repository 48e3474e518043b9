#include <algorithm>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/rgbd.h"
#include "dvi/labels/mask_folder.h"

namespace dvi::datasets {
namespace {

// Lists the files "frame-N.KIND.ENDING" in order of their numbers.
std::vector<NumberedFile> list_files_of_kind(const fs::path& path, const std::string& kind,
                                             const std::vector<std::string>& endings) {
  std::vector<NumberedFile> out;
  for (const fs::path& file : list_files(path, endings)) {
    const std::string stem = file.stem().string();
    if (!stem.starts_with("frame-") || !stem.ends_with("." + kind)) continue;
    const std::string name = stem.substr(0, stem.size() - kind.size() - 1);
    if (const auto number = to_integer(name.substr(name.find('-') + 1))) out.push_back({*number, name, file});
  }
  std::sort(out.begin(), out.end(), [](const NumberedFile& a, const NumberedFile& b) { return a.number < b.number; });
  return out;
}

// The depth camera is that of the authors. They calibrated neither the color camera nor its pose relative to the depth camera.
// As usual with these recordings, the color camera is assumed to be the nominal one of the first Kinect, mounted as measured on
// another one (https://projet.liris.cnrs.fr/voir/activities-dataset/kinect-calibration.html).
constexpr Camera kKinectColor{.fx = 525, .fy = 525, .cx = 320, .cy = 240};

SE3 color_from_kinect_depth() {
  const Eigen::Matrix3d R = (Eigen::Matrix3d() << 0.999965, 0.0026765, -0.0079041,  //
                             -0.0027409, 0.999963, -0.0081505,                      //
                             0.0078820, 0.0081718, 0.9999355)
                                .finished();
  return {nearest_rotation(R), {-0.025559, 0.000101, 0.002032}};
}

Camera read_kinect_camera(const fs::path& path, Drive& drive) {
  Camera camera{.fx = 585, .fy = 585, .cx = 320, .cy = 240};
  if (const fs::path file = path / "camera-intrinsics.txt"; fs::exists(file)) {
    const std::vector<TextLine> lines = read_text_lines(file);
    if (lines.size() != 3) throw InputError(file, "has " + std::to_string(lines.size()) + " lines instead of 3");
    const auto first = lines[0].numbers<3>(0), second = lines[1].numbers<3>(0);
    camera.fx = first[0], camera.cx = first[2], camera.fy = second[1], camera.cy = second[2];
    drive.other_files.push_back(file);
  }
  return camera;
}

DriveContents read_seven_scenes(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  name_camera(drive, options.camera, "color");
  set_numbered_files(drive, list_files_of_kind(path, "color", kImageEndings), list_files_of_kind(path, "depth", {".png"}),
                     list_files_of_kind(path, "pose", {".txt"}));
  labels::match_masks(drive, {path / "masks"});
  recording.gaps = {find_missing_numbers(drive), find_frames_without_depth(drive, 0)};
  drive.camera = kKinectColor;
  set_rgbd_cameras(recording,
                   {.camera = read_kinect_camera(path, drive), .depth_from_color = color_from_kinect_depth().inverse()},
                   PosedCamera::depth);
  return recording;
}

bool recognize_seven_scenes(const fs::path& path) {
  return !list_files_of_kind(path, "color", kImageEndings).empty() && !list_files_of_kind(path, "depth", {".png"}).empty();
}

}  // namespace

DriveFormat seven_scenes_format() {
  return {"7-scenes", "frame-N.color.png, frame-N.depth.png and frame-N.pose.txt in one folder", recognize_seven_scenes,
          read_seven_scenes};
}

}  // namespace dvi::datasets
