#include "dvi/datasets/depth_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/geometry/plausible.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"

namespace dvi::datasets {
namespace {

constexpr ushort kSaturated = std::numeric_limits<ushort>::max();
constexpr double kMinDepthM = 0.05, kMaxDepthM = 100;  // the range of all depth cameras

bool is_depth(ushort value) { return value != 0 && value != kSaturated; }

/// Decides whether a neighbor lies on another surface. A surface that joins the two would be observed at less than 6 degrees,
/// even after the noise is subtracted. The noise of triangulating cameras grows with the square of the depth (Nguyen et al.,
/// 3DIMPVT 2012).
class Jump {
 public:
  explicit Jump(const Camera& camera) : pixel_(1 / std::min(camera.fx, camera.fy)) {}

  bool operator()(double a_m, double b_m) const {
    constexpr double kMaxSlope = 10, kNoiseM = 0.006;  // depth per width; three standard deviations at one meter
    const double near = std::min(a_m, b_m);
    return std::abs(a_m - b_m) > kMaxSlope * pixel_ * near + kNoiseM * near * near;
  }

 private:
  double pixel_;
};

// Returns a mask of the pixels that the sensor measured on one surface.
cv::Mat1b find_measured_pixels(const cv::Mat1w& depth, const Jump& jump, double meter) {
  cv::Mat1b out(depth.size(), uchar{0});
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) out(y, x) = is_depth(depth(y, x)) ? 255 : 0;
  const auto part = [&](int y, int x, int v, int u) {
    const ushort a = depth(y, x), b = depth(v, u);
    if (is_depth(a) && is_depth(b) && jump(a * meter, b * meter)) out(y, x) = out(v, u) = 0;
  };
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      if (x + 1 < depth.cols) part(y, x, y, x + 1);
      if (y + 1 < depth.rows) part(y, x, y + 1, x);
    }
  return out;
}

void require_depths(const cv::Mat1w& depth, double meter, const fs::path& file) {
  ushort least = kSaturated, most = 0;
  for (const ushort value : depth)
    if (is_depth(value)) least = std::min(least, value), most = std::max(most, value);
  if (most == 0) throw InputError(file, "holds no depth", "remove the file; a missing depth image is tolerated");
  if (most * meter >= kMinDepthM && least * meter <= kMaxDepthM) return;
  throw InputError(
      file,
      fmt::format("holds values from {} to {}, which would be {:.3g} to {:.3g} m at {:g} units per meter", least, most,
                  least * meter, most * meter, 1 / meter),
      most * meter < kMinDepthM
          ? "depth images are expected in millimeters, and these seem to be in meters; set [depth] units_per_meter in dvi.toml"
          : "set [depth] units_per_meter in dvi.toml");
}

}  // namespace

Scan DepthScan::operator()(const ScanHeader& header) const {
  return (*this)(media::read_png_depth(header.file, {camera.width, camera.height}), header.file);
}

Scan DepthScan::operator()(const cv::Mat1w& image, const fs::path& name) const {
  const double meter = 1 / units_per_meter;
  require_depths(image, meter, name);
  const cv::Mat1b surface = find_measured_pixels(image, Jump(camera), meter);
  Scan scan;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (surface(y, x) != 0)
        scan.points.emplace_back((lidar_from_depth * (meter * image(y, x) * camera.ray({x, y}))).cast<float>());
  scan.intensity.assign(scan.size(), 0.0F);
  scan.time.assign(scan.size(), 0.0F);
  return scan;
}

DepthScan make_depth_scan(Drive& drive, const DepthCamera& depth, cv::Size size, const fs::path& name) {
  drive.sensor = Sensor::depth_camera;
  drive.registered_depth = !depth.depth_from_color;
  Camera camera = depth.camera.value_or(drive.camera);
  if (camera.width == 0) camera.width = size.width, camera.height = size.height;
  if (size != cv::Size(camera.width, camera.height))
    throw InputError(
        name,
        fmt::format("is {}x{} pixels, but {} {}x{}", size.width, size.height, depth.camera ? "its camera is" : "the images are",
                    camera.width, camera.height),
        "depth images that differ in size from the images need their own camera: set K in the table [depth] of dvi.toml");
  if (depth.camera) require_plausible(camera, name, "its camera's");
  if (const std::string problem = describe_off_center_problem(camera); depth.camera && !problem.empty())
    drive.warnings.push_back(name.filename().string() + " " + problem + "; check K in the table [depth] of dvi.toml");
  const SE3 color_from_depth = depth.depth_from_color ? depth.depth_from_color->inverse() : SE3();
  return {camera, drive.camera_from_lidar.inverse() * color_from_depth, depth.units_per_meter};
}

DepthScan attach_depth_camera(Drive& drive, const DepthCamera& depth) {
  const Camera fallback = depth.camera.value_or(drive.camera);
  const cv::Size stated(fallback.width, fallback.height);
  const fs::path file = drive.scan_headers.empty() ? drive.path : drive.scan_headers.front().file;
  const DepthScan scan = make_depth_scan(drive, depth, drive.scan_headers.empty() ? stated : media::image_size(file), file);
  drive.depth_images = {scan.camera, depth.depth_from_color, depth.units_per_meter};
  return scan;
}

}  // namespace dvi::datasets
