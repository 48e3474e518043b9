#include "dvi/report/unobserved_cells.h"

#include <array>
#include <cmath>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "dvi/geometry/camera_json.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::report {
namespace {

constexpr int kStepPx = 4;  // smaller than a cell up to a large depth

UnobservedCells find_cells(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above) {
  UnobservedCells cells;
  if (pictures.kind.empty() || pictures.depth.empty() || !above.contains("world_from_camera")) return cells;
  const nlohmann::json& poses = above.at("world_from_camera");
  if (frame >= poses.size()) return cells;
  const auto pose = poses[frame].get<std::array<double, 12>>();
  const Eigen::Matrix<double, 3, 4> world_from_camera =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(pose.data());
  const Camera camera = camera_from_json(above.at("camera"));
  for (int y = 0; y < pictures.kind.rows; y += kStepPx)
    for (int x = 0; x < pictures.kind.cols; x += kStepPx) {
      const ushort depth = pictures.depth(y, x);
      if (pictures.kind(y, x) < static_cast<uchar>(harmonize::Kind::interpolated) || depth == 0) continue;
      const Eigen::Vector3d at =
          world_from_camera.leftCols<3>() * camera.ray({x, y}) * (depth / 256.0) + world_from_camera.col(3);
      UnobservedCell& cell = cells[{static_cast<int>(std::floor(at.x() / kUnobservedCellM)),
                                    static_cast<int>(std::floor(at.y() / kUnobservedCellM))}];
      cell.frame = frame;
      ++cell.pixels;
    }
  return cells;
}

}  // namespace

UnobservedCells find_unobserved_cells(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above) {
  try {
    return find_cells(pictures, frame, above);
  } catch (const nlohmann::json::exception&) {  // a damaged map/above.json has no cells
    return {};
  }
}

void add(const UnobservedCells& frame, UnobservedCells& sum) {
  for (const auto& [place, cell] : frame)
    if (UnobservedCell& largest = sum[place]; cell.pixels > largest.pixels) largest = cell;
}

}  // namespace dvi::report
