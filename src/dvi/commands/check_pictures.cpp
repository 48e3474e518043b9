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

// Of 256 steps from red over yellow, green to blue.
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

cv::Vec3b color_of(double part) { return rainbow()[static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * 255)]; }

// Where the world's x and y lie in a picture from above.
class Ground {
 public:
  Ground(double left, double right, double bottom, double top) : left_(left), top_(top) {
    constexpr double kLongest = 1600;  // pixels
    constexpr double kFinest = 0.05;   // meters a pixel
    meter_ = 1 / std::max({kFinest, (right - left) / kLongest, (top - bottom) / kLongest});
    size_ = cv::Size(std::max(1, static_cast<int>((right - left) * meter_)),
                     std::max(1, static_cast<int>((top - bottom) * meter_)));
  }
  cv::Point operator()(const Eigen::Vector3d& p) const {
    return {static_cast<int>(std::floor((p.x() - left_) * meter_)), static_cast<int>(std::floor((top_ - p.y()) * meter_))};
  }
  cv::Size size() const { return size_; }
  double meter() const { return meter_; }

 private:
  double left_, top_, meter_;
  cv::Size size_;
};

std::vector<Eigen::Vector3d> path_of(const Drive& drive, const Trajectory& world_from_lidar) {
  std::vector<Eigen::Vector3d> path;
  for (const Frame& frame : drive.frames)
    if (const auto pose = world_from_lidar.at(frame.time_ns)) path.push_back(pose->t);
  return path;
}

// Evenly spread; all where they are few.
std::vector<std::size_t> spread(std::size_t count, std::size_t most) {
  std::set<std::size_t> out;
  for (std::size_t k = 0; k < most && count > 0; ++k) out.insert(most == 1 ? 0 : k * (count - 1) / (most - 1));
  return {out.begin(), out.end()};
}

// The points of the map that a drive brings within some meters of a place, the farthest first.
std::vector<Eigen::Vector3d> map_near(const Drive& drive, const Eigen::Vector3d& place, double range) {
  const std::shared_ptr<const GivenMap> map = drive.map[0];
  std::vector<Eigen::Vector3d> out;
  for (const Eigen::Vector3f& point : map->points)
    if (const Eigen::Vector3d p = map->origin + point.cast<double>(); (p - place).norm() < range) out.push_back(p);
  std::stable_sort(out.begin(), out.end(),
                   [&](const auto& a, const auto& b) { return (a - place).norm() > (b - place).norm(); });
  return out;
}

// What was measured at a time, world axes.
std::vector<Eigen::Vector3d> measured(const Drive& drive, std::int64_t time, const Trajectory& world_from_lidar, double range) {
  if (!drive.map.empty()) return map_near(drive, world_from_lidar.at(time)->t, range);
  const auto nearest = nearest_in_time(drive.scan_headers.begin(), drive.scan_headers.end(), time);
  if (nearest == drive.scan_headers.end()) return {};
  return to_world(*drive.scans[static_cast<std::size_t>(nearest - drive.scan_headers.begin())], *nearest, world_from_lidar);
}

}  // namespace

cv::Mat3b lidar_on_image(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar) {
  constexpr double kNear = 3, kFar = 60;  // meters, whose logarithms the colors are
  cv::Mat3b out = drive.images[frame]->clone();
  const std::int64_t time = drive.frames[frame].time_ns;
  const auto here = world_from_lidar.at(time);
  if (!here) return out;
  const SE3 camera_from_world = drive.camera_from_lidar * here->inverse();
  const int radius = std::max(1, out.cols / 900);
  for (const Eigen::Vector3d& p : measured(drive, time, world_from_lidar, kFar)) {
    const Eigen::Vector3d x = camera_from_world * p;
    if (x.z() < drive.min_range_m() || !drive.camera.in_front(x)) continue;
    const Eigen::Vector2d pixel = drive.camera.project(x);
    if (!drive.camera.contains(pixel)) continue;
    cv::circle(out, {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))}, radius,
               cv::Scalar(color_of(std::log(x.z() / kNear) / std::log(kFar / kNear))), cv::FILLED);
  }
  return out;
}

cv::Mat3b birds_view(const Drive& drive, const Trajectory& world_from_lidar) {
  constexpr double kMargin = 40, kLow = -3, kHigh = 5;  // meters about the path, and below and above it
  constexpr std::size_t kMostScans = 40, kPointStep = 3;
  const std::vector<Eigen::Vector3d> path = path_of(drive, world_from_lidar);
  if (path.empty()) return {};
  Eigen::Vector3d low = path.front(), high = path.front();
  for (const Eigen::Vector3d& p : path) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Ground ground(low.x() - kMargin, high.x() + kMargin, low.y() - kMargin, high.y() + kMargin);
  cv::Mat3b out(ground.size(), cv::Vec3b(20, 20, 20));
  cv::Mat1f top(ground.size(), static_cast<float>(kLow));
  const cv::Rect all(cv::Point(), out.size());
  const auto draw = [&](const std::vector<Eigen::Vector3d>& points, double level, std::size_t step) {
    for (std::size_t k = 0; k < points.size(); k += step) {
      const cv::Point at = ground(points[k]);
      const auto height = static_cast<float>(points[k].z() - level);
      if (!all.contains(at) || height > kHigh || height <= top(at)) continue;
      top(at) = height;
      out(at) = color_of(1 - (height - kLow) / (kHigh - kLow));
    }
  };
  for (const std::size_t i : spread(drive.scan_headers.size(), kMostScans))
    if (const auto here = world_from_lidar.at(drive.scan_headers[i].time_ns))
      draw(to_world(*drive.scans[i], drive.scan_headers[i], world_from_lidar, kPointStep), here->t.z(), kPointStep);
  if (!drive.map.empty())
    draw(map_near(drive, path[path.size() / 2], (path.front() - path.back()).norm() + kMargin), path[path.size() / 2].z(), 1);
  for (std::size_t i = 1; i < path.size(); ++i)
    cv::line(out, ground(path[i - 1]), ground(path[i]), cv::Scalar::all(255), 2, cv::LINE_AA);
  cv::circle(out, ground(path.front()), 6, cv::Scalar(0, 255, 0), cv::FILLED, cv::LINE_AA);
  cv::circle(out, ground(path.back()), 6, cv::Scalar(0, 0, 255), cv::FILLED, cv::LINE_AA);
  constexpr double kBar = 10;
  const cv::Point bar(20, out.rows - 20);
  cv::line(out, bar, bar + cv::Point(static_cast<int>(kBar * ground.meter()), 0), cv::Scalar::all(255), 3);
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
    for (const std::size_t i : spread(drive.frames.size(), 3))
      write("lidar_on_image_" + drive.frames[i].name + ".png", lidar_on_image(drive, i, world_from_lidar));
  write("birds_view.png", birds_view(drive, world_from_lidar));
  return files;
}

}  // namespace dvi::commands
