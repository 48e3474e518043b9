#include "dvi/io/given_map.h"

#include "dvi/core/error.h"
#include "dvi/io/colmap_model.h"
#include "dvi/io/plausible.h"
#include "dvi/io/point_cloud.h"

namespace dvi::io {

std::optional<fs::path> find_map(const fs::path& drive) {
  std::optional<fs::path> found;
  for (const char* name : {"map.ply", "map.pcd", "map.las"}) {
    if (!fs::exists(drive / name)) continue;
    if (found) throw InputError(drive / name, "lies beside " + found->filename().string(), "leave one of the two there");
    found = drive / name;
  }
  return found;
}

void attach_map(Drive& drive, const fs::path& file) {
  drive.map_file = file;
  drive.other_files.push_back(file);
  drive.map = Lazy<GivenMap>(1, [file](std::size_t) {
    PointCloud cloud = file.stem() == "points3D" ? read_colmap_points(file) : read_map_cloud(file);
    require_near(cloud.origin, file, "its first point");
    return GivenMap{cloud.origin, std::move(cloud.points), std::move(cloud.intensity)};
  });
}

}  // namespace dvi::io
