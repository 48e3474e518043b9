#include "dvi/odometry/rgbd_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "dvi/drive/nearest_in_time.h"
#include "dvi/image/gray.h"

namespace dvi::odometry {
namespace {

constexpr std::int64_t kMaxColorDelayNs = 25'000'000;
constexpr int kMaxWidthPx = 400, kMinWidthPx = 32, kMaxLevels = 4;
constexpr float kMaxDepthDifference = 0.05F;  // relative difference in depth of points that may lie on one surface

int compute_reduction(const Camera& camera) {
  int factor = 1;
  while (camera.width / factor > kMaxWidthPx) ++factor;
  return factor;
}

Pinhole reduce(const Camera& camera, int factor) {
  const auto scale = [&](double center) { return static_cast<float>((center + 0.5) / factor - 0.5); };
  return {static_cast<float>(camera.fx / factor), static_cast<float>(camera.fy / factor), scale(camera.cx), scale(camera.cy)};
}

/// The gray image at the finest level, without distortion.
cv::Mat1f make_gray_image(const cv::Mat3b& image, const Camera& camera, const Pinhole& pinhole, int factor) {
  const cv::Size size(camera.width / factor, camera.height / factor);
  const cv::Mat1b gray = gray_8bit(image(cv::Rect(0, 0, size.width * factor, size.height * factor)));
  cv::Mat small;
  cv::resize(gray, small, size, 0, 0, cv::INTER_AREA);
  cv::Mat1f out;
  small.convertTo(out, CV_32F);
  if (!camera.is_distorted()) return out;
  cv::Mat2f sources(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Eigen::Vector2d at = camera.project(pinhole.ray(x, y).cast<double>());
      sources(y, x) = {static_cast<float>((at.x() + 0.5) / factor - 0.5), static_cast<float>((at.y() + 0.5) / factor - 0.5)};
    }
  cv::Mat1f straight;
  cv::remap(out, straight, sources, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return straight;
}

/// The mean of the nearest points of each pixel.
cv::Mat3f project_points(const Scan& scan, const SE3& camera_from_scan, const Pinhole& pinhole, cv::Size size) {
  const Eigen::Matrix3f R = camera_from_scan.R.cast<float>();
  const Eigen::Vector3f t = camera_from_scan.t.cast<float>();
  cv::Mat1f nearest(size, std::numeric_limits<float>::infinity()), count(size, 0.0F);
  cv::Mat3f out(size, cv::Vec3f());
  std::vector<std::pair<int, Eigen::Vector3f>> seen;
  seen.reserve(scan.size());
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3f p = R * point + t;
    if (!(p.z() > 0.05F)) continue;
    const Eigen::Vector2f at = pinhole.project(p);
    const auto x = static_cast<int>(std::floor(at.x() + 0.5F)), y = static_cast<int>(std::floor(at.y() + 0.5F));
    if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
    nearest(y, x) = std::min(nearest(y, x), p.z());
    seen.emplace_back(y * size.width + x, p);
  }
  for (const auto& [pixel, p] : seen) {
    const int y = pixel / size.width, x = pixel % size.width;
    if (p.z() > nearest(y, x) * (1 + kMaxDepthDifference)) continue;
    out(y, x) += cv::Vec3f(p.x(), p.y(), p.z());
    count(y, x) += 1;
  }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (count(y, x) > 0) out(y, x) *= 1 / count(y, x);
  return out;
}

cv::Mat3f halve(const cv::Mat3f& points) {
  cv::Mat3f out(points.rows / 2, points.cols / 2, cv::Vec3f());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const std::array<cv::Vec3f, 4> four{points(2 * y, 2 * x), points(2 * y, 2 * x + 1), points(2 * y + 1, 2 * x),
                                          points(2 * y + 1, 2 * x + 1)};
      float nearest = std::numeric_limits<float>::infinity(), count = 0;
      for (const cv::Vec3f& p : four)
        if (p[2] > 0) nearest = std::min(nearest, p[2]);
      for (const cv::Vec3f& p : four)
        if (p[2] > 0 && p[2] <= nearest * (1 + kMaxDepthDifference)) out(y, x) += p, count += 1;
      if (count > 0) out(y, x) *= 1 / count;
    }
  return out;
}

RgbdLevel halve(const RgbdLevel& level) {
  const auto scale = [](float center) { return (center + 0.5F) / 2 - 0.5F; };
  const Pinhole& c = level.camera;
  RgbdLevel out{{c.fx / 2, c.fy / 2, scale(c.cx), scale(c.cy)}, {}, halve(level.points)};
  if (level.gray.empty()) return out;
  const cv::Rect even(0, 0, 2 * out.points.cols, 2 * out.points.rows);
  cv::resize(level.gray(even), out.gray, out.points.size(), 0, 0, cv::INTER_AREA);
  return out;
}

}  // namespace

std::vector<RgbdMoment> pair_depth_with_color(const Drive& drive) {
  std::vector<RgbdMoment> out;
  for (std::size_t i = 0; i < drive.scan_headers.size(); ++i) {
    const std::int64_t time = drive.scan_headers[i].time_ns;
    RgbdMoment moment{i, std::nullopt, time, 0};
    const Frame* frame = drive.images.empty() ? nullptr : nearest_in_time(drive.frames, time, kMaxColorDelayNs);
    if (frame != nullptr && nearest_in_time(drive.scan_headers, frame->time_ns, kMaxColorDelayNs) == &drive.scan_headers[i]) {
      moment.frame = static_cast<std::size_t>(frame - drive.frames.data());
      moment.time_ns = frame->time_ns;
      moment.depth_delay_s = 1e-9 * static_cast<double>(time - frame->time_ns);
    }
    out.push_back(moment);
  }
  return out;
}

Pinhole get_finest_camera(const Camera& camera) { return reduce(camera, compute_reduction(camera)); }

RgbdImage read_rgbd_image(const Drive& drive, const RgbdMoment& moment, const Vector6d& twist) {
  const int factor = compute_reduction(drive.camera);
  const Pinhole pinhole = reduce(drive.camera, factor);
  SE3 color_from_depth;
  if (std::abs(moment.depth_delay_s) > kMinDelayS) color_from_depth = se3_exp(twist * moment.depth_delay_s);
  RgbdImage out;
  RgbdLevel& finest = out.levels.emplace_back();
  finest.camera = pinhole;
  finest.points = project_points(*drive.scans[moment.scan_index], color_from_depth * drive.camera_from_lidar, pinhole,
                                 {drive.camera.width / factor, drive.camera.height / factor});
  if (moment.frame) finest.gray = make_gray_image(*drive.images[*moment.frame], drive.camera, pinhole, factor);
  while (static_cast<int>(out.levels.size()) < kMaxLevels && out.levels.back().points.cols / 2 >= kMinWidthPx)
    out.levels.push_back(halve(out.levels.back()));
  return out;
}

cv::Mat3f compute_normals(const RgbdLevel& level, int stride) {
  cv::Mat3f out(level.points.size(), cv::Vec3f());
  for (int y = stride; y + stride < out.rows; ++y)
    for (int x = stride; x + stride < out.cols; ++x) {
      const Eigen::Vector3f p = level.point(y, x);
      if (p.z() <= 0) continue;
      const std::array<Eigen::Vector3f, 4> around{level.point(y, x - stride), level.point(y, x + stride),
                                                  level.point(y - stride, x), level.point(y + stride, x)};
      const auto apart = [&](const Eigen::Vector3f& q) { return std::abs(q.z() - p.z()) > kMaxDepthDifference * p.z(); };
      if (std::any_of(around.begin(), around.end(), apart)) continue;
      const Eigen::Vector3f normal = (around[1] - around[0]).cross(around[3] - around[2]).normalized();
      out(y, x) = {normal.x(), normal.y(), normal.z()};
    }
  return out;
}

}  // namespace dvi::odometry
