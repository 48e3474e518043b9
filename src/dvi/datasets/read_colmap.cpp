#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/colmap_model.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/map_file.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/rgbd.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

constexpr std::int64_t kFramePeriodNs = 100'000'000;  // between images, since models have no times

// The images of one camera by their NAME: those of one folder below images/.
using ModelImages = std::map<std::string, ColmapImage>;

// Groups images by camera: "front/0001.jpg" is of camera "front"; images without a folder are of "camera".
std::map<std::string, ModelImages> group_by_camera(const ColmapModel& model, const fs::path& file) {
  std::map<std::string, ModelImages> cameras;
  for (const ColmapImage& image : model.images) {
    const fs::path path = image.name;
    std::string camera = path.has_parent_path() ? path.parent_path().string() : "camera";
    std::replace(camera.begin(), camera.end(), '/', '_');
    ModelImages& images = cameras[camera];
    if (!images.emplace(path.stem().string(), image).second)
      throw InputError(file, "has two images called " + path.stem().string());
    const ColmapImage& first = images.begin()->second;
    if (model.cameras.at(first.camera) != model.cameras.at(image.camera))
      throw InputError(file, first.name + " and " + image.name + " are in one folder, but of different cameras",
                       "each folder must have one camera; run COLMAP with single_camera_per_folder");
  }
  return cameras;
}

// Returns the pose of a camera relative to another one by their images of the same NAME; nothing if it is not constant.
std::optional<SE3> find_mount(const ModelImages& first, const ModelImages& other) {
  constexpr double kMaxShiftM = 0.1, kMaxTurnRad = 0.02;  // errors of the poses of a model
  std::optional<SE3> other_from_first;
  for (const auto& [name, image] : other) {
    const auto there = first.find(name);
    if (there == first.end()) continue;
    const SE3 here = image.camera_from_world * there->second.camera_from_world.inverse();
    if (!other_from_first) other_from_first = here;
    const SE3 moved = other_from_first->inverse() * here;
    if (moved.t.norm() > kMaxShiftM || Eigen::AngleAxisd(moved.R).angle() > kMaxTurnRad) return std::nullopt;
  }
  return other_from_first;
}

using Names = std::set<std::string, NaturalLess>;

Names collect_names(const std::map<std::string, ModelImages>& cameras) {
  Names names;
  for (const auto& [camera, images] : cameras)
    for (const auto& [name, image] : images) names.insert(name);
  return names;
}

// Returns the numbers of the names if all are different whole numbers, else their indices.
std::map<std::string, int> assign_numbers(const Names& names) {
  std::map<std::string, int> numbers;
  std::set<int> known;
  for (const std::string& name : names)
    if (const auto number = is_all_digits(name) ? to_integer(name) : std::nullopt; number && known.insert(*number).second)
      numbers[name] = *number;
  if (numbers.size() == names.size()) return numbers;
  numbers.clear();
  for (int place = 0; const std::string& name : names) numbers[name] = place++;
  return numbers;
}

void set_frames(Drive& drive, const ModelImages& images, const Names& names, const SE3& camera_from_body) {
  const std::map<std::string, int> numbers = assign_numbers(names);
  if (const auto order = describe_order({names.begin(), names.end()})) drive.warnings.push_back(*order);
  std::map<int, std::string> in_order;
  for (const auto& [name, number] : numbers) in_order[number] = name;
  std::vector<StampedPose> poses;
  for (std::int64_t time = 0; const auto& [number, name] : in_order) {
    if (const auto image = images.find(name); image != images.end()) {
      drive.frames.push_back({number, name, time, drive.path / "images" / image->second.name, {}});
      poses.push_back({time, image->second.camera_from_world.inverse() * camera_from_body});
    }
    time += kFramePeriodNs;
  }
  drive.poses = Trajectory(std::move(poses));
}

// The scale of a model that COLMAP made of the images alone is arbitrary.
void set_map(Drive& drive, const fs::path& model) {
  for (const auto& file :
       {find_map(drive.path), std::optional(drive.path / "dense/fused.ply"), std::optional(drive.path / "fused.ply")})
    if (file && fs::exists(*file)) return attach_map(drive, *file);
  const fs::path points = find_colmap_points_file(model);
  if (points.empty()) throw InputError(drive.path, "has no map", "add map.ply, map.pcd or map.las, or dense/fused.ply");
  attach_map(drive, points);
  drive.warnings.push_back("the map is " + points.filename().string() +
                           " only; map.ply, map.pcd or map.las of a LiDAR is much denser");
}

void warn_of_unposed(Drive& drive, const ModelImages& images) {
  std::size_t unposed = 0;
  const fs::path folder = (drive.path / "images" / images.begin()->second.name).parent_path();
  for (const fs::path& file : list_files(folder, kImageEndings)) unposed += images.contains(file.stem().string()) ? 0 : 1;
  if (unposed > 0)
    drive.warnings.push_back(fmt::format("{} images of {} are not in the model and are ignored", unposed, drive.camera_name));
}

DriveContents read_colmap(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  const fs::path folder = find_colmap_model(path);
  const ColmapModel model = read_colmap_model(folder);
  drive.other_files = model.files;
  if (const std::vector<fs::path> models = list_colmap_models(path); models.size() > 1)
    drive.warnings.push_back(fmt::format("{} is the largest of the {} models in {} ({} images); the others are ignored",
                                         folder.filename().string(), models.size(), folder.parent_path().string(),
                                         model.images.size()));
  std::map<std::string, ModelImages> cameras = group_by_camera(model, model.files.back());
  const ModelImages first = cameras.begin()->second;
  // The world is level if the first camera is.
  std::map<std::string, SE3> camera_from_body;
  for (const auto& [name, images] : cameras) {
    const auto on_first = &images == &cameras.begin()->second ? SE3() : find_mount(first, images);
    if (on_first)
      camera_from_body[name] = *on_first * camera_from_level();
    else
      drive.warnings.push_back(
          fmt::format("camera {} is not mounted rigidly on {} and is ignored", name, cameras.begin()->first));
  }
  for (const auto& [name, pose] : camera_from_body) drive.camera_names.push_back(name);
  drive.camera_name = choose_camera(drive, options.camera, {});
  const ModelImages& images = cameras.at(drive.camera_name);
  drive.camera = model.cameras.at(images.begin()->second.camera);
  drive.camera_from_lidar = camera_from_body.at(drive.camera_name);
  drive.camera_is_posed = true;
  set_frames(drive, images, collect_names(cameras), drive.camera_from_lidar);
  set_map(drive, folder);
  warn_of_unposed(drive, images);
  labels::match_masks(drive, {labels::camera_masks(path, drive.camera_name)});
  if (const auto config = read_drive_config(path)) config->apply(drive);
  return recording;
}

bool recognize_colmap(const fs::path& path) {
  return fs::is_directory(path / "images") && !fs::exists(path / "lidar") && !fs::exists(path / "depth") &&
         fs::is_directory(path / "sparse") && !find_colmap_model(path).empty();
}

}  // namespace

DriveFormat colmap_format() {
  return {"colmap",
          "images/ and sparse/0 of COLMAP with poses, and map.ply (or .pcd, .las) instead of scans",
          recognize_colmap,
          read_colmap,
          {"images", "sparse"}};
}

}  // namespace dvi::datasets
