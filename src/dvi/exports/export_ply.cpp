#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/exports/scene_files.h"

namespace dvi::exports {
namespace {

ExportReport write_ply(const Result& result, const fs::path& folder, const ExportOptions&, Progress&) {
  const fs::path map = result.folder() / "map/map.ply";
  const std::size_t points = read_map_cloud(map).size();  // verifies that the file is complete
  copy_picture(map, folder / "map.ply");
  return {{"map.ply"}, {{"points", static_cast<double>(points)}}};
}

}  // namespace

ExportFormat ply_format() {
  return {"ply", "the static map, colored, with normals, intensity and times (CloudCompare, MeshLab)", write_ply};
}

}  // namespace dvi::exports
