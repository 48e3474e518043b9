#include "dvi/objects/static_depth.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/objects/half_size.h"

namespace dvi::objects {
namespace {

struct StaticDepthParams {
  double window_s = 1;        ///< scans before and after: they fill gaps, and observe surfaces behind moving objects
  double min_height_m = 0.2;  ///< above ground; lower returns count as ground, whose height is known more accurately
  double box_margin_m = 0.5;  ///< margin of the boxes of objects, which move while they are scanned
  int filled_gap_px = 2;      ///< pixels of half size on each side of a gap that are filled
  double min_depth_m = 1;     ///< from the camera
  double max_range_m = 80;    ///< from the LiDAR; beyond, rays are too far apart to show the boundary of a surface
};
constexpr StaticDepthParams kStaticDepth{};

using StaticReturns = std::vector<Eigen::Vector3f>;  // world axes

// Returns the boxes of the frame nearest to a time, world axes.
std::vector<Box> find_boxes(const StaticScene& scene, std::int64_t time_ns) {
  std::vector<Box> boxes;
  const auto nearest = nearest_in_time(scene.drive.frames.begin(), scene.drive.frames.end(), time_ns);
  if (nearest == scene.drive.frames.end()) return boxes;
  const auto pose = scene.world_from_lidar.at(nearest->time_ns);
  if (!pose) return boxes;
  for (const Label& label : (*scene.objects)[static_cast<std::size_t>(nearest - scene.drive.frames.begin())])
    if (label.box) boxes.push_back({*pose * label.box->frame_from_box, label.box->size});
  return boxes;
}

StaticReturns find_static_returns(const StaticScene& scene, std::size_t scan) {
  const ScanHeader& header = scene.drive.scan_headers[scan];
  const auto pose = scene.world_from_lidar.at(header.time_ns);
  const std::vector<Eigen::Vector3d> world = to_world(*scene.drive.scans[scan], header, scene.world_from_lidar);
  StaticReturns out;
  if (!pose) return out;
  const std::vector<Box> boxes = find_boxes(scene, header.time_ns);
  const auto labels = scene.drive.point_labels.empty() ? nullptr : scene.drive.point_labels[scan];
  for (std::size_t i = 0; i < world.size(); ++i) {
    if (labels && labels->values[i] != 0) continue;
    const Eigen::Vector3d& x = world[i];
    const double range = (x - pose->t).norm();
    if (range < scene.drive.min_range_m() || range > kStaticDepth.max_range_m) continue;
    const auto height = scene.ground->height(x.head<2>());
    if (height && x.z() < *height + kStaticDepth.min_height_m) continue;
    if (std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return box.contains(x, kStaticDepth.box_margin_m); }))
      continue;
    out.emplace_back(x.cast<float>());
  }
  return out;
}

// Draws a depth, if it is the nearest, into a pixel and its neighbors, which is about the distance between returns.
void draw_depth(cv::Mat1f& depth, cv::Point at, float z) {
  for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, depth.rows - 1); ++y)
    for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, depth.cols - 1); ++x)
      if (float& there = depth(y, x); there == 0 || z < there) there = z;
}

// Fills empty pixels with the nearest of the depths of their neighbors.
void fill_gaps(cv::Mat1f& depth) {
  const cv::Mat1f known = depth.clone();
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      if (known(y, x) != 0) continue;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, depth.rows - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, depth.cols - 1); ++u)
          if (const float z = known(v, u); z != 0 && (depth(y, x) == 0 || z < depth(y, x))) depth(y, x) = z;
    }
}

void draw_returns(const StaticReturns& returns, const View& view, cv::Mat1f& depth) {
  for (const Eigen::Vector3f& point : returns) {
    const Eigen::Vector3d x = view.camera_from_world * Eigen::Vector3d(point.cast<double>());
    if (view.camera.depth(x) < kStaticDepth.min_depth_m || !view.camera.in_front(x)) continue;
    const cv::Point2f at = to_half_size(view.camera.project(x));
    if (at.x > -1 && at.y > -1 && at.x < static_cast<float>(depth.cols) && at.y < static_cast<float>(depth.rows))
      draw_depth(depth, {cvRound(at.x), cvRound(at.y)}, static_cast<float>(view.camera.depth(x)));
  }
}

}  // namespace

Lazy<cv::Mat1f> render_static_depth(const StaticScene& scene, const Views& views) {
  const Lazy<StaticReturns> returns(scene.drive.scan_headers.size(),
                                    [scene](std::size_t scan) { return find_static_returns(scene, scan); });
  return {views.size(), [returns, &headers = scene.drive.scan_headers, list = views.views](std::size_t i) {
            const View& view = list[i];
            cv::Mat1f depth(view.camera.height / kHalfSizeFactor, view.camera.width / kHalfSizeFactor, 0.F);
            const std::int64_t window_ns = std::llround(1e9 * kStaticDepth.window_s);
            const auto first = std::partition_point(headers.begin(), headers.end(), [&](const ScanHeader& header) {
              return header.time_ns < view.time_ns - window_ns;
            });
            for (auto header = first; header != headers.end() && header->time_ns <= view.time_ns + window_ns; ++header)
              draw_returns(*returns[static_cast<std::size_t>(header - headers.begin())], view, depth);
            for (int pass = 0; pass < kStaticDepth.filled_gap_px; ++pass) fill_gaps(depth);
            return depth;
          }};
}

}  // namespace dvi::objects
