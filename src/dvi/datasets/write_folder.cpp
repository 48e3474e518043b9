#include "dvi/datasets/write_folder.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "dvi/core/draft.h"
#include "dvi/core/json_text.h"
#include "dvi/core/median.h"
#include "dvi/core/text.h"
#include "dvi/core/threads.h"
#include "dvi/datasets/gps.h"
#include "dvi/datasets/scan_time.h"
#include "dvi/geometry/camera_toml.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/write_image.h"
#include "dvi/media/write_ply.h"

namespace dvi::datasets {
namespace {

std::string format_camera(const Drive& drive) {
  return fmt::format("[camera.\"{}\"]\nsize = [{}, {}]\n{}camera_from_lidar = [{}]\n\n", drive.camera_name, drive.camera.width,
                     drive.camera.height, format_intrinsics(drive.camera),
                     fmt::join(to_row_major(drive.camera_from_lidar), ", "));
}

std::string format_depth(const DepthImages& depth) {
  std::string text = fmt::format("[depth]\nunits_per_meter = {}\n{}", depth.units_per_meter, format_intrinsics(depth.camera));
  if (depth.depth_from_color)
    text += fmt::format("depth_from_color = [{}]\n", fmt::join(to_row_major(*depth.depth_from_color), ", "));
  return text;
}

std::string format_settings(const Drive& drive, const std::vector<Drive>& more_cameras) {
  std::string text = fmt::format("[drive]\nversion = 1\ncamera = \"{}\"\n\n", drive.camera_name) + format_camera(drive);
  for (const Drive& camera : more_cameras) text += format_camera(camera);
  text += fmt::format("[lidar]\nrate = {}\nstamp = \"middle\"\nrotation = \"clockwise\"\nfirst_azimuth_deg = 180.0\n",
                      compute_scan_rate(drive));
  if (drive.sensor == Sensor::depth_camera) text += "sensor = \"depth_camera\"\n";
  if (drive.depth_images) text += "\n" + format_depth(*drive.depth_images);
  return text;
}

std::string format_times(const std::vector<Frame>& frames) {
  std::string text;
  for (const Frame& frame : frames) text += fmt::format("{} {}\n", frame.name, to_seconds(frame.time_ns));
  return text;
}

// Writes start and end only if they do not follow from `rate`.
std::string format_times(const std::vector<ScanHeader>& scan_headers, double rate) {
  std::string text;
  const std::int64_t half = std::llround(1e9 / rate) / 2;
  for (const ScanHeader& header : scan_headers) {
    text += fmt::format("{} {}", header.name, to_seconds(header.time_ns));
    if (header.start_ns != header.time_ns - half || header.end_ns != header.time_ns + half)
      text += fmt::format(" {} {}", to_seconds(header.start_ns), to_seconds(header.end_ns));
    text += "\n";
  }
  return text;
}

std::string format_poses(const Drive& drive) {
  std::map<std::int64_t, std::string> scans;
  for (const ScanHeader& header : drive.scan_headers) scans[header.time_ns] = header.name;
  std::string text;
  for (const StampedPose& pose : drive.poses.poses()) {
    const auto scan = scans.find(pose.time_ns);
    const std::string when = scan == scans.end() ? "@" + to_seconds(pose.time_ns) : scan->second;
    text += fmt::format("{} {}\n", when, fmt::join(to_row_major(pose.world_from_body), " "));
  }
  return text;
}

nlohmann::json to_json(const Label& label) {
  nlohmann::json json = {{"track", label.track}, {"class", label.type}};
  if (label.box) {
    const Eigen::Vector3d &c = label.box->frame_from_box.t, &size = label.box->size;
    const Eigen::Matrix3d& R = label.box->frame_from_box.R;
    json["center"] = {c.x(), c.y(), c.z()};
    json["size"] = {size.x(), size.y(), size.z()};
    json["yaw"] = std::atan2(R(1, 0), R(0, 0));
    if (so3_exp({0, 0, json["yaw"].get<double>()}) != R)
      json["rotation"] = {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
  }
  if (label.rect) json["rect"] = {label.rect->x, label.rect->y, label.rect->width, label.rect->height};
  if (label.instance)
    json["outline"] = {{"size", {label.instance->size.height, label.instance->size.width}}, {"counts", label.instance->runs}};
  return json;
}

std::string format_boxes(const Drive& drive, const std::vector<Drive>& more_cameras) {
  nlohmann::json frames = nlohmann::json::object();
  const auto add = [&](const Drive& camera) {
    for (const Frame& frame : camera.frames) {
      if (frames.contains(frame.name)) continue;
      frames[frame.name] = nlohmann::json::array();  // the frame is labeled, but shows no object
      for (const Label& label : frame.labels) frames[frame.name].push_back(to_json(label));
    }
  };
  add(drive);
  if (drive.labeled_around)
    for (const Drive& camera : more_cameras)
      if (camera.has_labels()) add(camera);
  nlohmann::json document = {{"version", 1}, {"frames", frames}};
  if (!drive.labeled_around) document["camera"] = drive.camera_name;
  return json_text(document) + "\n";
}

bool have_times_by_azimuth(const Scan& scan, const ScanHeader& header) {
  constexpr float kTolerance = 1e-4F;  // seconds; 1.5 mm at 15 m/s
  const std::vector<float> expected = times_by_azimuth(scan.points, header, {});
  return std::equal(expected.begin(), expected.end(), scan.time.begin(),
                    [](float a, float b) { return std::abs(a - b) <= kTolerance; });
}

// Returns the ending of an image file that can be copied; an empty text if the frame is part of a file of another kind.
std::string find_image_ending(const fs::path& file) {
  const std::string ending = to_lower_case(file.extension().string());
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg" ? ending : "";
}

void copy_bytes(const fs::path& from, const fs::path& to) { write_file(to, read_file(from)); }

void write_pictures(const fs::path& folder, const Drive& drive, const Tick& tick) {
  const fs::path images = folder / "images" / drive.camera_name, masks = folder / "masks" / drive.camera_name;
  make_folder(images);
  if (!drive.mask_files.empty()) make_folder(masks);
  parallel_for(drive.frames.size(), [&](std::size_t i) {
    const Frame& frame = drive.frames[i];
    if (const std::string ending = find_image_ending(frame.file); !ending.empty())
      copy_bytes(frame.file, images / (frame.name + ending));
    else
      media::write_png(images / (frame.name + ".png"), *drive.images[i]);
    if (!drive.mask_files.empty() && !drive.mask_files[i].empty())
      copy_bytes(drive.mask_files[i], masks / (frame.name + ".png"));
    if (tick) tick();
  });
}

// Writes the map in the world of the poses, as it was given.
void write_map(const fs::path& folder, const Drive& drive) {
  const std::string ending = drive.map_file.extension().string();
  if (ending == ".ply" || ending == ".pcd" || ending == ".las") return copy_bytes(drive.map_file, folder / ("map" + ending));
  const std::shared_ptr<const GivenMap> map = drive.map[0];
  media::write_ply(folder / "map.ply", {map->points, {}, {{"intensity", map->intensity}}, {}, map->origin});
}

}  // namespace

double compute_scan_rate(const Drive& drive) {
  std::vector<std::int64_t> lengths;
  for (const ScanHeader& header : drive.scan_headers) lengths.push_back(header.end_ns - header.start_ns);
  const std::int64_t length = median(std::move(lengths));
  return length > 0 ? 1e9 / static_cast<double>(length) : 10;
}

void write_folder_scan(const fs::path& folder, const ScanHeader& header, const Scan& scan) {
  if (have_times_by_azimuth(scan, header)) {
    write_file(folder / "lidar" / (header.name + ".bin"), media::to_bin_bytes(scan));
    return;
  }
  std::vector<float> t = scan.time;
  for (float& seconds : t) seconds += static_cast<float>(1e-9 * static_cast<double>(header.time_ns - header.start_ns));
  const std::vector<float> ring(scan.ring.begin(), scan.ring.end());
  media::PlyCloud cloud{scan.points, {}, {{"intensity", scan.intensity}, {"t", t}}, {}};
  if (!ring.empty()) cloud.scalars.push_back({"ring", ring});
  media::write_ply(folder / "lidar" / (header.name + ".ply"), cloud);
}

void write_folder_tables(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras) {
  write_file(folder / "times" / (drive.camera_name + ".txt"), format_times(drive.frames));
  for (const Drive& camera : more_cameras)
    write_file(folder / "times" / (camera.camera_name + ".txt"), format_times(camera.frames));
  if (drive.map.empty()) write_file(folder / "times/lidar.txt", format_times(drive.scan_headers, compute_scan_rate(drive)));
  if (!drive.poses.empty()) write_file(folder / "poses.txt", format_poses(drive));
  if (!drive.fixes.empty()) write_file(folder / "gps.txt", format_fixes(drive.fixes));
  if (drive.has_labels()) write_file(folder / "boxes.json", format_boxes(drive, more_cameras));
  write_file(folder / "dvi.toml", format_settings(drive, more_cameras));
}

void write_folder(const fs::path& place, const Drive& drive, const std::vector<Drive>& more_cameras, const Tick& tick) {
  require_empty(place, "drive");
  Draft draft = draft_folder(place);
  const fs::path& folder = draft.path();
  make_folder(folder / "times");
  write_pictures(folder, drive, tick);
  for (const Drive& camera : more_cameras) write_pictures(folder, camera, tick);
  const fs::path scans = drive.depth_images ? folder / "depth" / drive.camera_name : folder / "lidar";
  if (drive.map.empty())
    make_folder(scans);
  else
    write_map(folder, drive);
  parallel_for(drive.scan_headers.size(), [&](std::size_t i) {
    const ScanHeader& header = drive.scan_headers[i];
    if (drive.depth_images)
      copy_bytes(header.file, scans / (header.name + ".png"));
    else
      write_folder_scan(folder, header, *drive.scans[i]);
    if (tick) tick();
  });
  write_folder_tables(folder, drive, more_cameras);
  draft.finish();
}

}  // namespace dvi::datasets
