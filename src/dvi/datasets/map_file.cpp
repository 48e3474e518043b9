#include "dvi/datasets/map_file.h"

#include <array>
#include <set>
#include <utility>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/colmap_model.h"
#include "dvi/geometry/plausible.h"
#include "dvi/media/point_cloud.h"

namespace dvi::datasets {

namespace {

// Formats of point clouds and meshes that are not supported, each with its remedy.
constexpr std::array<std::pair<const char*, const char*>, 12> kUnreadMapFormats{{
    {".laz", "decompress it to map.las, such as by las2las or pdal translate"},
    {".e57", "convert it to map.las or map.ply, such as by CloudCompare or pdal translate"},
    {".pts", "convert it to map.ply, such as by CloudCompare"},
    {".ptx", "convert it to map.ply, such as by CloudCompare"},
    {".xyz", "convert it to map.ply, such as by CloudCompare or pdal translate"},
    {".txt", "convert it to map.ply, such as by CloudCompare or pdal translate"},
    {".csv", "convert it to map.ply, such as by CloudCompare or pdal translate"},
    {".asc", "convert it to map.ply, such as by CloudCompare or pdal translate"},
    {".npy", "convert it to map.ply"},
    {".bin", "convert it to map.ply"},
    {".obj", "sample points of its surface and write them as map.ply, such as by CloudCompare"},
    {".stl", "sample points of its surface and write them as map.ply, such as by CloudCompare"},
}};

}  // namespace

void refuse_other_map(const fs::path& drive) {
  if (!fs::is_directory(drive)) return;
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(drive)) files.insert(entry.path());
  for (const fs::path& file : files)
    for (const auto& [ending, remedy] : kUnreadMapFormats)
      if (to_lower_case(file.filename().string()).starts_with("map.") && to_lower_case(file.extension().string()) == ending)
        throw InputError(file, "is in a format that is not supported for maps (.ply, .pcd and .las are)", remedy);
}

std::optional<fs::path> find_map(const fs::path& drive) {
  std::optional<fs::path> found;
  for (const char* name : {"map.ply", "map.pcd", "map.las"}) {
    if (!fs::exists(drive / name)) continue;
    if (found) throw InputError(drive / name, "lies beside " + found->filename().string(), "remove one of the two");
    found = drive / name;
  }
  return found;
}

void attach_map(Drive& drive, const fs::path& file) {
  drive.map_file = file;
  drive.other_files.push_back(file);
  drive.map = Lazy<GivenMap>(1, [file](std::size_t) {
    media::PointCloud cloud = file.stem() == "points3D" ? read_colmap_points(file) : media::read_map_cloud(file);
    require_near(cloud.origin, file, "its first point");
    return GivenMap{cloud.origin, std::move(cloud.points), std::move(cloud.intensity)};
  });
}

}  // namespace dvi::datasets
