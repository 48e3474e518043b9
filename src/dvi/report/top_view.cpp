#include "dvi/report/above.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"
#include "dvi/core/scratch.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/write_image.h"

namespace dvi::report {
namespace {

constexpr double kMargin = 50;        // meters around the path: what lies farther is seen sparsely
constexpr double kFinest = 0.1;       // meters a pixel: the map's voxels leave holes below
constexpr int kLargest = 2400;        // px
constexpr float kAboveSensor = 0.5F;  // meters: crowns of trees and bridges would hide the road
const cv::Vec4b kRemoved(60, 60, 230, 255);

/// Pixels of the picture: x to the right, y of the world up.
struct Raster {
  double left = 0, top = 0, meters = kFinest;
  cv::Size size;

  explicit Raster(const std::vector<SE3>& path) {
    Eigen::Vector2d low(0, 0), high(0, 0);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Eigen::Vector2d at = path[i].t.head<2>();
      low = i == 0 ? at : Eigen::Vector2d(low.cwiseMin(at));
      high = i == 0 ? at : Eigen::Vector2d(high.cwiseMax(at));
    }
    const Eigen::Vector2d extent = high - low + Eigen::Vector2d::Constant(2 * kMargin);
    meters = std::max(kFinest, extent.maxCoeff() / kLargest);
    left = low.x() - kMargin;
    top = high.y() + kMargin;
    size = {static_cast<int>(extent.x() / meters), static_cast<int>(extent.y() / meters)};
  }
  /// Outside of the picture for points beyond it.
  cv::Point pixel(const Eigen::Vector3f& at) const {
    return {static_cast<int>(std::floor((at.x() - left) / meters)), static_cast<int>(std::floor((top - at.y()) / meters))};
  }
};

/// The highest point of a cell that is not far above the sensor that saw it.
cv::Mat4b picture_of(const Above& above, const Raster& raster) {
  const cv::Rect inside({}, raster.size);
  cv::Mat4b picture(raster.size, cv::Vec4b(0, 0, 0, 0));
  cv::Mat1f height(raster.size, -std::numeric_limits<float>::infinity());
  const map::StaticMap& map = above.map;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    page_out_sometimes(i);
    const map::MapPoint& point = map.points[i];
    const cv::Point at = raster.pixel(point.position);
    if (!inside.contains(at) || !point.is_present_in(0) || point.position.z() <= height(at)) continue;
    if (point.position.z() > map.scans[point.first].sensor.z() + kAboveSensor) continue;
    height(at) = point.position.z();
    const cv::Vec3b color = above.color(i);
    picture(at) = {color[0], color[1], color[2], 255};
  }
  for (const map::RemovedPoint& point : map.removed)
    if (const cv::Point at = raster.pixel(point.position); inside.contains(at)) picture(at) = kRemoved;
  return picture;
}

double rounded(double value) { return std::round(value * 1000) / 1000; }

nlohmann::json json_of(const ObjectPath& track) {
  nlohmann::json points = nlohmann::json::array();
  for (std::size_t i = 0; i < track.points.size(); ++i)
    points.push_back({rounded(track.points[i].x()), rounded(track.points[i].y()), track.frames[i]});
  return {{"track", track.number}, {"type", track.type}, {"points", points}};
}

}  // namespace

void write_above(const fs::path& folder, const Above& above) {
  const Raster raster(above.world_from_camera);
  media::write_png(folder / "map.png", picture_of(above, raster));
  nlohmann::json poses = nlohmann::json::array(), tracks = nlohmann::json::array();
  for (const SE3& pose : above.world_from_camera) poses.push_back(row_major(pose));
  for (const ObjectPath& track : above.tracks) tracks.push_back(json_of(track));
  const Camera& c = above.camera;
  write_file(folder / "above.json", json_text({{"schema", "dvi-above/1"},
                                               {"left_m", raster.left},
                                               {"top_m", raster.top},
                                               {"meters_per_px", raster.meters},
                                               {"width", raster.size.width},
                                               {"height", raster.size.height},
                                               {"camera", {c.width, c.height, c.fx, c.fy, c.cx, c.cy}},
                                               {"distortion", c.distortion},
                                               {"world_from_camera", poses},
                                               {"tracks", tracks}},
                                              -1) +
                                        "\n");
}

}  // namespace dvi::report
