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

/// One image of a COLMAP model.
struct ColmapImage {
  std::string name;  ///< path relative to the folder of images
  std::uint32_t camera = 0;
  SE3 camera_from_world;
};

/// The cameras and images of a COLMAP model.
struct ColmapModel {
  std::map<std::uint32_t, Camera> cameras;
  std::vector<ColmapImage> images;  ///< sorted by name
  std::vector<fs::path> files;      ///< the files that the model was read from
};

/// Lists the model folders of a COLMAP workspace: those in sparse/, such as sparse/0; else sparse/ itself; else the same for
/// the workspace.
std::vector<fs::path> list_colmap_models(const fs::path& workspace);

/// Finds the model with the most images, the first one if several have the same number. Returns an empty path if there is no
/// model.
fs::path find_colmap_model(const fs::path& workspace);

/// Reads the cameras and images of a model from text or binary files (cameras.bin, images.bin). Shifts the principal points by
/// half a pixel, since COLMAP puts the center of the first pixel at (0.5, 0.5) and dvi at (0, 0). Throws InputError if a file
/// is damaged or if dvi does not support a camera model.
ColmapModel read_colmap_model(const fs::path& folder);

/// Returns the file of the model's points, points3D.bin or points3D.txt; an empty path if there is none.
fs::path find_colmap_points_file(const fs::path& folder);

/// Reads the points of a file points3D.bin or points3D.txt. Throws InputError if it is damaged or holds no points.
media::PointCloud read_colmap_points(const fs::path& file);

}  // namespace dvi::datasets
