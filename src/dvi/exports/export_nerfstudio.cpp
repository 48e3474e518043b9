#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/json_text.h"
#include "dvi/core/threads.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/exports/scene_files.h"
#include "dvi/media/write_image.h"
#include "dvi/media/write_ply.h"

namespace dvi::exports {
namespace {

// Converts depth to the loader's default unit, 16-bit millimeters. Depths beyond 65.5 m become unknown.
cv::Mat1w to_millimeters(const cv::Mat1f& depth) {
  cv::Mat1w out(depth.size(), ushort{0});
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      if (depth(y, x) < 65.535F) out(y, x) = cv::saturate_cast<ushort>(1000 * depth(y, x));
  return out;
}

// Converts to the camera axes of OpenGL: x right, y up, z backward.
nlohmann::json to_opengl_pose(const SE3& world_from_camera) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = world_from_camera.R * Eigen::Vector3d(1, -1, -1).asDiagonal();
  m.topRightCorner<3, 1>() = world_from_camera.t;
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 4; ++r) rows.push_back(std::array<double, 4>{m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return rows;
}

void write_cloud(const fs::path& file, const std::vector<CloudPoint>& cloud) {
  std::vector<Eigen::Vector3f> points;
  std::vector<cv::Vec3b> colors;
  for (const CloudPoint& p : cloud) {
    points.push_back(p.position);
    colors.push_back(p.color);
  }
  media::write_ply(file, {points, colors});
}

// Returns the intrinsics. The pixel centers of nerfstudio are at (0.5, 0.5), as in COLMAP.
nlohmann::json make_intrinsics(const Camera& c) {
  nlohmann::json out{{"w", c.width}, {"h", c.height}, {"fl_x", c.fx}, {"fl_y", c.fy}, {"cx", c.cx + 0.5}, {"cy", c.cy + 0.5}};
  const bool is_fisheye = c.model == CameraModel::fisheye;
  const std::vector<const char*> names =
      is_fisheye ? std::vector{"k1", "k2", "k3", "k4"} : std::vector{"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t k = 0; k < names.size(); ++k) out[names[k]] = c.distortion[k];
  return out;
}

// Returns the name of the model of all cameras.
std::string find_model(const Result& result) {
  const CameraModel model = result.cameras().front().camera.model;
  for (const auto& [name, camera] : result.cameras()) {
    if (camera.model != model)
      throw InputError(result.folder(),
                       fmt::format("nerfstudio's cameras have one model, but {} is {} and {} is {}", name,
                                   to_string(camera.model), result.cameras().front().name, to_string(model)),
                       "export the result of a run with --camera for each model");
    if (camera.coefficients().size() > 5 || camera.model == CameraModel::unified || camera.model == CameraModel::cylindrical)
      throw InputError(result.folder(), fmt::format("nerfstudio has no cameras with the distortion of {}", name),
                       "undistort the images first, or export the format colmap");
  }
  if (model == CameraModel::fisheye) return "OPENCV_FISHEYE";
  return model == CameraModel::equirectangular ? "EQUIRECTANGULAR" : "OPENCV";
}

// The intrinsics of several cameras are those of each frame.
nlohmann::json make_transforms(const Result& result, const std::string& model) {
  const bool has_one = result.cameras().size() == 1;
  nlohmann::json frames = nlohmann::json::array();
  for (const ResultFrame& frame : result.frames()) {
    frames.push_back({{"file_path", "images/" + frame.name + ".png"},
                      {"mask_path", "masks/" + frame.name + ".png"},
                      {"depth_file_path", "depth/" + frame.name + ".png"},
                      {"transform_matrix", to_opengl_pose(frame.world_from_camera)}});
    if (!has_one) frames.back().update(make_intrinsics(result.cameras()[frame.camera].camera));
  }
  nlohmann::json out{{"camera_model", model}, {"frames", frames}, {"ply_file_path", "map.ply"}};
  if (has_one) out.update(make_intrinsics(result.cameras().front().camera));
  return out;
}

ExportReport write_nerfstudio(const Result& result, const fs::path& folder, const ExportOptions& options, Progress& progress) {
  const std::string model = find_model(result);  // before anything is written
  write_images_and_masks(result, folder, ".png", progress);
  make_folders_of_cameras(result, folder / "depth");
  parallel_for(result.frames().size(), [&](std::size_t i) {
    media::write_png(folder / "depth" / (result.frames()[i].name + ".png"), to_millimeters(result.depth(i)));
  });
  std::vector<CloudPoint> cloud = read_map_cloud(result.folder() / "map/map.ply");
  std::erase_if(cloud, [](const CloudPoint& p) { return !p.colored(); });
  cloud = thin_cloud(cloud, static_cast<std::size_t>(options.max_points));
  write_cloud(folder / "map.ply", cloud);
  write_file(folder / "transforms.json", json_text(make_transforms(result, model)) + "\n");
  return {{"transforms.json"},
          {{"images", static_cast<double>(result.frames().size())}, {"points", static_cast<double>(cloud.size())}}};
}

}  // namespace

ExportFormat nerfstudio_format() {
  return {"nerfstudio",
          "transforms.json with images, masks of unobserved pixels, depth and the map (nerfstudio, instant-ngp)",
          write_nerfstudio,
          {},
          {"export.max_points"}};
}

}  // namespace dvi::exports
