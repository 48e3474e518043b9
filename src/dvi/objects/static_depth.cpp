#include "dvi/objects/static_depth.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/objects/half_size.h"

namespace dvi::objects {
namespace {

constexpr double kStandingWindow = 1;   // seconds each way: scans fill each other's gaps, and see past what moves
constexpr double kAbove = 0.2;          // meters: what is lower is drawn as ground, of which the height is better known
constexpr double kScanMargin = 0.5;     // meters: objects move while they are scanned
constexpr int kGap = 2;                 // half pixels each side that are filled
constexpr double kNearest = 1;          // meters from the camera
constexpr double kFarthestReturn = 80;  // meters from the LiDAR: beyond, rays are too far apart to tell where something ends

// World axes.
using StandingReturns = std::vector<Eigen::Vector3f>;

struct Source {
  Drive drive;
  Trajectory world_from_lidar;
  SharedLabels objects;
  std::shared_ptr<const ground::ScanGround> ground;

  StandingReturns operator()(std::size_t scan) const {
    const ScanHeader& header = drive.scan_headers[scan];
    const auto pose = world_from_lidar.at(header.time_ns);
    const std::vector<Eigen::Vector3d> world = to_world(*drive.scans[scan], header, world_from_lidar);
    StandingReturns out;
    if (!pose) return out;
    const std::vector<Box> boxes = boxes_at(header.time_ns);
    for (const Eigen::Vector3d& x : world) {
      const double range = (x - pose->t).norm();
      if (range < drive.min_range_m() || range > kFarthestReturn) continue;
      const auto height = ground->height(x.head<2>());
      if (height && x.z() < *height + kAbove) continue;
      if (std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) { return box.contains(x, kScanMargin); })) continue;
      out.emplace_back(x.cast<float>());
    }
    return out;
  }

 private:
  // World axes, of the frame nearest in time.
  std::vector<Box> boxes_at(std::int64_t time_ns) const {
    std::vector<Box> boxes;
    const auto nearest = nearest_in_time(drive.frames.begin(), drive.frames.end(), time_ns);
    if (nearest == drive.frames.end()) return boxes;
    const auto pose = world_from_lidar.at(nearest->time_ns);
    if (!pose) return boxes;
    for (const Label& label : (*objects)[static_cast<std::size_t>(nearest - drive.frames.begin())])
      if (label.box) boxes.push_back({*pose * label.box->frame_from_box, label.box->size});
    return boxes;
  }
};

// Sets the nearest depth in the pixel and those beside it: returns are that far apart.
void put(cv::Mat1f& depth, cv::Point at, float z) {
  for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, depth.rows - 1); ++y)
    for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, depth.cols - 1); ++x)
      if (float& there = depth(y, x); there == 0 || z < there) there = z;
}

// Gaps take the nearest of the depths beside them.
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

}  // namespace

Lazy<cv::Mat1f> static_depth(const Drive& drive, const Trajectory& world_from_lidar, const SharedLabels& objects,
                             const Views& views, const std::shared_ptr<const ground::ScanGround>& ground) {
  const Lazy<StandingReturns> returns(drive.scan_headers.size(), Source{drive, world_from_lidar, objects, ground});
  return {views.size(), [=, headers = drive.scan_headers, list = views.views](std::size_t i) {
            const View& view = list[i];
            cv::Mat1f depth(view.camera.height / kScale, view.camera.width / kScale, 0.F);
            const std::int64_t window = std::llround(1e9 * kStandingWindow);
            const auto first = std::partition_point(headers.begin(), headers.end(), [&](const ScanHeader& header) {
              return header.time_ns < view.time_ns - window;
            });
            for (auto header = first; header != headers.end() && header->time_ns <= view.time_ns + window; ++header)
              for (const Eigen::Vector3f& point : *returns[static_cast<std::size_t>(header - headers.begin())]) {
                const Eigen::Vector3d x = view.camera_from_world * Eigen::Vector3d(point.cast<double>());
                if (x.z() < kNearest || !view.camera.in_front(x)) continue;
                const cv::Point2f at = half_size(view.camera.project(x));
                if (at.x > -1 && at.y > -1 && at.x < static_cast<float>(depth.cols) && at.y < static_cast<float>(depth.rows))
                  put(depth, {cvRound(at.x), cvRound(at.y)}, static_cast<float>(x.z()));
              }
            for (int pass = 0; pass < kGap; ++pass) fill_gaps(depth);
            return depth;
          }};
}

}  // namespace dvi::objects
