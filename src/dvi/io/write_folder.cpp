#include "dvi/io/write_folder.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/json_text.h"
#include "dvi/core/median.h"
#include "dvi/io/point_cloud.h"
#include "dvi/io/rigid.h"
#include "dvi/io/scan_time.h"
#include "dvi/io/text.h"
#include "dvi/io/write_ply.h"

namespace dvi::io {
namespace {

std::string camera_settings(const Drive& drive) {
  const Camera& c = drive.camera;
  std::string text = fmt::format("[camera.\"{}\"]\nsize = [{}, {}]\nK = [{:.12g}, 0, {:.12g}, 0, {:.12g}, {:.12g}, 0, 0, 1]\n",
                                 drive.camera_name, c.width, c.height, c.fx, c.cx, c.fy, c.cy);
  if (c.distorted()) text += fmt::format("distortion = [{:.12g}]\n", fmt::join(c.distortion, ", "));
  return text + fmt::format("camera_from_lidar = [{:.12g}]\n\n", fmt::join(row_major(drive.camera_from_lidar), ", "));
}

std::string settings(const Drive& drive, const std::vector<Drive>& more_cameras) {
  std::string text = fmt::format("[drive]\nversion = 1\ncamera = \"{}\"\n\n", drive.camera_name) + camera_settings(drive);
  for (const Drive& camera : more_cameras) text += camera_settings(camera);
  text += fmt::format("[lidar]\nrate = {:.12g}\nstamp = \"middle\"\nrotation = \"clockwise\"\nfirst_azimuth_deg = 180.0\n",
                      scan_rate(drive));
  if (drive.sensor == Sensor::depth_camera) text += "sensor = \"depth_camera\"\n";
  return text;
}

template <class Stamped>
std::string times(const std::vector<Stamped>& items) {
  std::string text;
  for (const Stamped& item : items) text += fmt::format("{} {}\n", item.name, to_seconds(item.time_ns));
  return text;
}

std::string poses(const Drive& drive) {
  std::string text;
  for (const ScanHeader& header : drive.scan_headers)
    if (const std::optional<SE3> pose = drive.poses.at(header.time_ns))
      text += fmt::format("{} {:.12g}\n", header.name, fmt::join(row_major(*pose), " "));
  return text;
}

std::string boxes(const Drive& drive) {
  nlohmann::json frames = nlohmann::json::object();
  for (const Frame& frame : drive.frames) {
    frames[frame.name] = nlohmann::json::array();  // labelled, though it shows none
    for (const Label& label : frame.labels) {
      if (!label.box) continue;
      const Eigen::Vector3d &c = label.box->frame_from_box.t, &size = label.box->size;
      const Eigen::Matrix3d& R = label.box->frame_from_box.R;
      frames[frame.name].push_back({{"track", label.track},
                                    {"class", label.type},
                                    {"center", {c.x(), c.y(), c.z()}},
                                    {"size", {size.x(), size.y(), size.z()}},
                                    {"yaw", std::atan2(R(1, 0), R(0, 0))}});
    }
  }
  return json_text({{"version", 1}, {"frames", frames}}) + "\n";
}

bool times_follow(const Scan& scan, const ScanHeader& header) {
  constexpr float kTolerance = 1e-4F;  // seconds: 1.5 mm at 15 m/s
  const std::vector<float> expected = times_by_azimuth(scan.points, header, {});
  return std::equal(expected.begin(), expected.end(), scan.time.begin(),
                    [](float a, float b) { return std::abs(a - b) <= kTolerance; });
}

}  // namespace

double scan_rate(const Drive& drive) {
  std::vector<std::int64_t> lengths;
  for (const ScanHeader& header : drive.scan_headers) lengths.push_back(header.end_ns - header.start_ns);
  const std::int64_t length = median(std::move(lengths));
  return length > 0 ? 1e9 / static_cast<double>(length) : 10;
}

void write_folder_scan(const fs::path& folder, const ScanHeader& header, const Scan& scan, double rate) {
  const std::int64_t half = std::llround(1e9 / rate) / 2;
  const ScanHeader as_read{header.name, header.time_ns, header.time_ns - half, header.time_ns + half, {}};
  if (times_follow(scan, as_read)) {
    write_file(folder / "lidar" / (header.name + ".bin"), bin_bytes(scan));
    return;
  }
  std::vector<float> t = scan.time;
  for (float& seconds : t) seconds += static_cast<float>(1e-9 * static_cast<double>(half));
  const std::vector<float> ring(scan.ring.begin(), scan.ring.end());
  PlyCloud cloud{scan.points, {}, {{"intensity", scan.intensity}, {"t", t}}, {}};
  if (!ring.empty()) cloud.scalars.push_back({"ring", ring});
  write_ply(folder / "lidar" / (header.name + ".ply"), cloud);
}

void write_folder_tables(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras) {
  write_file(folder / "times" / (drive.camera_name + ".txt"), times(drive.frames));
  for (const Drive& camera : more_cameras) write_file(folder / "times" / (camera.camera_name + ".txt"), times(camera.frames));
  write_file(folder / "times/lidar.txt", times(drive.scan_headers));
  write_file(folder / "poses.txt", poses(drive));
  write_file(folder / "boxes.json", boxes(drive));
  write_file(folder / "dvi.toml", settings(drive, more_cameras));
}

}  // namespace dvi::io
