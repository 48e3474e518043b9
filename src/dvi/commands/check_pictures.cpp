#include "dvi/commands/check_pictures.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/deskew.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/media/write_image.h"

namespace dvi::commands {
namespace {

/// Returns 256 colors from red over yellow and green to blue.
const std::vector<cv::Vec3b>& rainbow() {
  static const std::vector<cv::Vec3b> colors = [] {
    cv::Mat1b steps(1, 256);
    for (int i = 0; i < 256; ++i) steps(0, i) = static_cast<uchar>(255 - i);
    cv::Mat3b out;
    cv::applyColorMap(steps, out, cv::COLORMAP_TURBO);
    return std::vector<cv::Vec3b>(out.begin(), out.end());
  }();
  return colors;
}

/// Returns the color of a share, from red (0) to blue (1).
cv::Vec3b color_of(double share) { return rainbow()[static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * 255)]; }

/// Projects the world's x and y to a picture from above.
class AboveProjection {
 public:
  AboveProjection(double left, double right, double bottom, double top) : left_(left), top_(top) {
    constexpr double kMaxSidePx = 1600, kMinPixelM = 0.05;
    px_per_m_ = 1 / std::max({kMinPixelM, (right - left) / kMaxSidePx, (top - bottom) / kMaxSidePx});
    size_ = cv::Size(std::max(1, static_cast<int>((right - left) * px_per_m_)),
                     std::max(1, static_cast<int>((top - bottom) * px_per_m_)));
  }
  cv::Point project(const Eigen::Vector3d& p) const {
    return {static_cast<int>(std::floor((p.x() - left_) * px_per_m_)),
            static_cast<int>(std::floor((top_ - p.y()) * px_per_m_))};
  }
  cv::Size size() const { return size_; }
  double px_per_m() const { return px_per_m_; }

 private:
  double left_, top_, px_per_m_;
  cv::Size size_;
};

std::vector<Eigen::Vector3d> path_of(const Drive& drive, const Trajectory& world_from_lidar) {
  std::vector<Eigen::Vector3d> path;
  for (const Frame& frame : drive.frames)
    if (const auto pose = world_from_lidar.at(frame.time_ns)) path.push_back(pose->t);
  return path;
}

/// Returns up to `most` indices below `count`, evenly spread.
std::vector<std::size_t> select_evenly(std::size_t count, std::size_t most) {
  std::set<std::size_t> out;
  for (std::size_t k = 0; k < most && count > 0; ++k) out.insert(most == 1 ? 0 : k * (count - 1) / (most - 1));
  return {out.begin(), out.end()};
}

/// Returns the points of the drive's own map within a range of a place, the farthest first.
std::vector<Eigen::Vector3d> map_points_near(const Drive& drive, const Eigen::Vector3d& place, double range_m) {
  const std::shared_ptr<const GivenMap> map = drive.map[0];
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector3f& point : map->points)
    if (const Eigen::Vector3d p = map->origin + point.cast<double>(); (p - place).norm() < range_m) out.push_back(p);
  std::stable_sort(out.begin(), out.end(),
                   [&](const auto& a, const auto& b) { return (a - place).norm() > (b - place).norm(); });
  return out;
}

/// Returns the points of the scan nearest to a time, in the world; those of the drive's own map within a range if it has one.
std::vector<Eigen::Vector3d> measured_points(const Drive& drive, std::int64_t time, const Trajectory& world_from_lidar,
                                             double range_m) {
  if (!drive.map.empty()) return map_points_near(drive, world_from_lidar.at(time)->t, range_m);
  const auto nearest = nearest_in_time(drive.scan_headers.begin(), drive.scan_headers.end(), time);
  if (nearest == drive.scan_headers.end()) return {};
  return to_world(*drive.scans[static_cast<std::size_t>(nearest - drive.scan_headers.begin())], *nearest, world_from_lidar);
}

}  // namespace

cv::Mat3b draw_lidar_on_image(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar) {
  constexpr double kMinDepthM = 3, kMaxDepthM = 60;  // the range of the logarithmic color scale
  cv::Mat3b out = drive.images[frame]->clone();
  const std::int64_t time = drive.frames[frame].time_ns;
  const auto here = world_from_lidar.at(time);
  if (!here) return out;
  const SE3 camera_from_world = drive.camera_from_lidar * here->inverse();
  const int radius = std::max(1, out.cols / 900);
  for (const Eigen::Vector3d& p : measured_points(drive, time, world_from_lidar, kMaxDepthM)) {
    const Eigen::Vector3d x = camera_from_world * p;
    if (drive.camera.depth(x) < drive.min_range_m() || !drive.camera.in_front(x)) continue;
    const Eigen::Vector2d pixel = drive.camera.project(x);
    if (!drive.camera.contains(pixel)) continue;
    cv::circle(out, {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))}, radius,
               cv::Scalar(color_of(std::log(drive.camera.depth(x) / kMinDepthM) / std::log(kMaxDepthM / kMinDepthM))),
               cv::FILLED);
  }
  return out;
}

cv::Mat3b draw_birds_view(const Drive& drive, const Trajectory& world_from_lidar) {
  constexpr double kMarginM = 40;                      // around the path
  constexpr double kMinHeightM = -3, kMaxHeightM = 5;  // above the path
  constexpr std::size_t kMaxScans = 40, kPointStep = 3;
  const std::vector<Eigen::Vector3d> path = path_of(drive, world_from_lidar);
  if (path.empty()) return {};
  Eigen::Vector3d low = path.front(), high = path.front();
  for (const Eigen::Vector3d& p : path) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const AboveProjection above(low.x() - kMarginM, high.x() + kMarginM, low.y() - kMarginM, high.y() + kMarginM);
  cv::Mat3b out(above.size(), cv::Vec3b(20, 20, 20));
  cv::Mat1f top(above.size(), static_cast<float>(kMinHeightM));
  const cv::Rect all(cv::Point(), out.size());
  const auto draw = [&](const std::vector<Eigen::Vector3d>& points, double level, std::size_t step) {
    for (std::size_t k = 0; k < points.size(); k += step) {
      const cv::Point at = above.project(points[k]);
      const auto height = static_cast<float>(points[k].z() - level);
      if (!all.contains(at) || height > kMaxHeightM || height <= top(at)) continue;
      top(at) = height;
      out(at) = color_of(1 - (height - kMinHeightM) / (kMaxHeightM - kMinHeightM));
    }
  };
  for (const std::size_t i : select_evenly(drive.scan_headers.size(), kMaxScans))
    if (const auto here = world_from_lidar.at(drive.scan_headers[i].time_ns))
      draw(to_world(*drive.scans[i], drive.scan_headers[i], world_from_lidar, kPointStep), here->t.z(), kPointStep);
  if (!drive.map.empty())
    draw(map_points_near(drive, path[path.size() / 2], (path.front() - path.back()).norm() + kMarginM),
         path[path.size() / 2].z(), 1);
  for (std::size_t i = 1; i < path.size(); ++i)
    cv::line(out, above.project(path[i - 1]), above.project(path[i]), cv::Scalar::all(255), 2, cv::LINE_AA);
  cv::circle(out, above.project(path.front()), 6, cv::Scalar(0, 255, 0), cv::FILLED, cv::LINE_AA);
  cv::circle(out, above.project(path.back()), 6, cv::Scalar(0, 0, 255), cv::FILLED, cv::LINE_AA);
  constexpr double kBarM = 10;
  const cv::Point bar(20, out.rows - 20);
  cv::line(out, bar, bar + cv::Point(static_cast<int>(kBarM * above.px_per_m()), 0), cv::Scalar::all(255), 3);
  cv::putText(out, "10 m", bar - cv::Point(0, 10), cv::FONT_HERSHEY_SIMPLEX, 0.6, cv::Scalar::all(255), 1, cv::LINE_AA);
  return out;
}

std::vector<std::string> write_check_pictures(const fs::path& folder, const Drive& drive, const Trajectory& world_from_lidar) {
  make_folder(folder);
  std::vector<std::string> files;
  const auto write = [&](const std::string& name, const cv::Mat3b& picture) {
    if (picture.empty()) return;
    media::write_png(folder / name, picture);
    files.push_back((folder / name).string());
  };
  if (drive.has_geometry())
    for (const std::size_t i : select_evenly(drive.frames.size(), 3))
      write("lidar_on_image_" + drive.frames[i].name + ".png", draw_lidar_on_image(drive, i, world_from_lidar));
  write("birds_view.png", draw_birds_view(drive, world_from_lidar));
  return files;
}

}  // namespace dvi::commands
