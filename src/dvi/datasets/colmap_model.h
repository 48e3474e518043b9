#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"
#include "dvi/media/point_cloud.h"

namespace dvi::datasets {

/// An image of a COLMAP model.
struct ColmapImage {
  std::string name;  ///< path below the folder of images
  std::uint32_t camera = 0;
  SE3 camera_from_world;
};

/// Cameras and images of a COLMAP model.
struct ColmapModel {
  std::map<std::uint32_t, Camera> cameras;
  std::vector<ColmapImage> images;  ///< by name
  std::vector<fs::path> files;      ///< that it was read from
};

/// Lists the folders of the models of a COLMAP workspace: those in sparse/, such as sparse/0; else sparse, the workspace
/// itself, or those in it.
std::vector<fs::path> list_colmap_models(const fs::path& workspace);

/// Finds the model with the most images, the first of those with equally many; empty if there is none.
fs::path find_colmap_model(const fs::path& workspace);

/// Reads cameras and images of a model, text or binary (cameras.bin, images.bin). COLMAP puts the center of the first pixel at
/// (0.5, 0.5), dvi at (0, 0). InputError where a file is damaged, or a camera is none that dvi knows.
ColmapModel read_colmap_model(const fs::path& folder);

/// The file of the model's points: points3D.bin or .txt; empty where there is none.
fs::path colmap_points_file(const fs::path& folder);

/// The points of such a file.
media::PointCloud read_colmap_points(const fs::path& file);

}  // namespace dvi::datasets
