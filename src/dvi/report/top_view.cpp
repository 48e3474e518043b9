#include "dvi/report/top_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"
#include "dvi/core/scratch.h"
#include "dvi/geometry/camera_json.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/write_image.h"

namespace dvi::report {
namespace {

constexpr double kMarginM = 50;     // around the path; points farther away are sparse
constexpr double kMinPixelM = 0.1;  // smaller pixels would have holes between the map's voxels
constexpr int kMaxSizePx = 2400;
constexpr float kMaxHeightAboveSensorM = 0.5F;  // excludes trees and bridges, which would hide the road
const cv::Vec4b kRemoved(60, 60, 230, 255);

/// The pixels of the image: x of the world to the right, y up.
struct Raster {
  double left = 0, top = 0, meters = kMinPixelM;
  cv::Size size;

  explicit Raster(const std::vector<SE3>& path) {
    Eigen::Vector2d low(0, 0), high(0, 0);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Eigen::Vector2d at = path[i].t.head<2>();
      low = i == 0 ? at : Eigen::Vector2d(low.cwiseMin(at));
      high = i == 0 ? at : Eigen::Vector2d(high.cwiseMax(at));
    }
    const Eigen::Vector2d extent = high - low + Eigen::Vector2d::Constant(2 * kMarginM);
    meters = std::max(kMinPixelM, extent.maxCoeff() / kMaxSizePx);
    left = low.x() - kMarginM;
    top = high.y() + kMarginM;
    size = {static_cast<int>(extent.x() / meters), static_cast<int>(extent.y() / meters)};
  }
  /// Returns the pixel of a position; it may be outside the image.
  cv::Point pixel(const Eigen::Vector3f& at) const {
    return {static_cast<int>(std::floor((at.x() - left) / meters)), static_cast<int>(std::floor((top - at.y()) / meters))};
  }
};

/// Draws the highest point of each pixel that is not far above its sensor.
cv::Mat4b draw(const TopView& view, const Raster& raster) {
  const cv::Rect inside({}, raster.size);
  cv::Mat4b picture(raster.size, cv::Vec4b(0, 0, 0, 0));
  cv::Mat1f height(raster.size, -std::numeric_limits<float>::infinity());
  const map::StaticMap& map = view.map;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    page_out_sometimes(i);
    const map::MapPoint& point = map.points[i];
    const cv::Point at = raster.pixel(point.position);
    if (!inside.contains(at) || !point.is_present_in(0) || point.position.z() <= height(at)) continue;
    if (point.position.z() > map.scans[point.first].sensor.z() + kMaxHeightAboveSensorM) continue;
    height(at) = point.position.z();
    const cv::Vec3b color = view.color(i);
    picture(at) = {color[0], color[1], color[2], 255};
  }
  for (const map::RemovedPoint& point : map.removed)
    if (const cv::Point at = raster.pixel(point.position); inside.contains(at)) picture(at) = kRemoved;
  return picture;
}

double round_to_mm(double value) { return std::round(value * 1000) / 1000; }

nlohmann::json to_json(const ObjectPath& track) {
  nlohmann::json points = nlohmann::json::array();
  for (std::size_t i = 0; i < track.points.size(); ++i)
    points.push_back({round_to_mm(track.points[i].x()), round_to_mm(track.points[i].y()), track.frames[i]});
  return {{"track", track.number}, {"type", track.type}, {"points", points}};
}

}  // namespace

void write_top_view(const fs::path& folder, const TopView& view) {
  const Raster raster(view.world_from_camera);
  media::write_png(folder / "map.png", draw(view, raster));
  nlohmann::json poses = nlohmann::json::array(), tracks = nlohmann::json::array();
  for (const SE3& pose : view.world_from_camera) poses.push_back(to_row_major(pose));
  for (const ObjectPath& track : view.tracks) tracks.push_back(to_json(track));
  write_file(folder / "above.json", json_text({{"schema", "dvi-above/2"},
                                               {"left_m", raster.left},
                                               {"top_m", raster.top},
                                               {"meters_per_px", raster.meters},
                                               {"width", raster.size.width},
                                               {"height", raster.size.height},
                                               {"camera", to_json(view.camera)},
                                               {"world_from_camera", poses},
                                               {"tracks", tracks}},
                                              -1) +
                                        "\n");
}

}  // namespace dvi::report
