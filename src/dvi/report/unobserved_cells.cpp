#include "dvi/report/unobserved_places.h"

#include <array>
#include <cmath>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "dvi/geometry/camera.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::report {
namespace {

constexpr int kStep = 4;  // px: half a meter is wider as far as places can be told apart

Camera camera_of(const nlohmann::json& above) {
  const auto numbers = above.at("camera").get<std::array<double, 6>>();
  return {.width = static_cast<int>(numbers[0]),
          .height = static_cast<int>(numbers[1]),
          .fx = numbers[2],
          .fy = numbers[3],
          .cx = numbers[4],
          .cy = numbers[5],
          .distortion = above.at("distortion").get<std::array<double, 5>>()};
}

UnobservedPlaces places_of(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above) {
  UnobservedPlaces places;
  if (pictures.kind.empty() || pictures.depth.empty() || !above.contains("world_from_camera")) return places;
  const nlohmann::json& poses = above.at("world_from_camera");
  if (frame >= poses.size()) return places;
  const auto pose = poses[frame].get<std::array<double, 12>>();
  const Eigen::Matrix<double, 3, 4> world_from_camera =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(pose.data());
  const Camera camera = camera_of(above);
  for (int y = 0; y < pictures.kind.rows; y += kStep)
    for (int x = 0; x < pictures.kind.cols; x += kStep) {
      const ushort depth = pictures.depth(y, x);
      if (pictures.kind(y, x) < static_cast<uchar>(harmonize::Kind::interpolated) || depth == 0) continue;
      const Eigen::Vector3d at =
          world_from_camera.leftCols<3>() * camera.ray({x, y}) * (depth / 256.0) + world_from_camera.col(3);
      UnobservedCell& cell = places[{static_cast<int>(std::floor(at.x() / kUnobservedCell)),
                                     static_cast<int>(std::floor(at.y() / kUnobservedCell))}];
      cell.frame = frame;
      ++cell.pixels;
    }
  return places;
}

}  // namespace

UnobservedPlaces unobserved_places(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above) {
  try {
    return places_of(pictures, frame, above);
  } catch (const nlohmann::json::exception&) {  // answered: a damaged map/above.json shows no places
    return {};
  }
}

void add(const UnobservedPlaces& frame, UnobservedPlaces& sum) {
  for (const auto& [place, cell] : frame)
    if (UnobservedCell& most = sum[place]; cell.pixels > most.pixels) most = cell;
}

}  // namespace dvi::report
