#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/kitti_calibration.h"
#include "dvi/datasets/kitti_files.h"
#include "dvi/datasets/pose_jumps.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/scan_files.h"
#include "dvi/geometry/angles.h"
#include "dvi/geometry/plausible.h"
#include "dvi/labels/labels.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

NumberedFiles list_images(const fs::path& drive, const std::string& camera) {
  return list_numbered_files(drive / camera / "data", kImageEndings);
}

std::vector<Frame> read_frames(const fs::path& drive, const std::string& camera) {
  std::vector<Frame> frames;
  const KittiStamps stamps(drive / camera / "timestamps.txt");
  for (const auto& [number, file] : list_images(drive, camera))
    frames.push_back({number, file.stem().string(), stamps.of(number, file), file, {}});
  return frames;
}

std::vector<ScanHeader> read_scan_headers(const fs::path& folder, std::vector<fs::path>& other_files) {
  constexpr std::int64_t kHalfPeriodNs = 50'000'000;  // at 10 Hz
  std::vector<ScanHeader> scan_headers;
  const NumberedFiles scans = list_numbered_files(folder / "data", {".bin"});
  if (scans.empty()) return scan_headers;
  const fs::path starts = folder / "timestamps_start.txt", ends = folder / "timestamps_end.txt";
  const bool spans = fs::exists(starts) && fs::exists(ends);
  const KittiStamps first(spans ? starts : folder / "timestamps.txt"), last(spans ? ends : folder / "timestamps.txt");
  for (const auto& [number, file] : scans) {
    const std::int64_t start = first.of(number, file) - (spans ? 0 : kHalfPeriodNs),
                       end = last.of(number, file) + (spans ? 0 : kHalfPeriodNs);
    scan_headers.push_back({file.stem().string(), start + (end - start) / 2, start, end, file});
  }
  if (spans)
    other_files.insert(other_files.end(), {starts, ends});
  else
    other_files.push_back(folder / "timestamps.txt");
  return scan_headers;
}

// Reads latitude and longitude in degrees, altitude, and roll, pitch, yaw in radians of an oxts packet.
std::array<double, 6> read_packet(const fs::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  const TextLine line(file, 1, lines.empty() ? "" : lines[0]);
  std::array<double, 6> packet;
  for (std::size_t i = 0; i < packet.size(); ++i) packet[i] = line.number(i);
  if (!(std::abs(packet[0]) < 90)) line.fail("latitude " + line.word(0) + " is not within 90 degrees");
  return packet;
}

// Converts a packet to a pose by the Mercator projection of KITTI's development kit; `scale` is the cosine of the drive's
// latitude.
SE3 to_mercator_pose(const std::array<double, 6>& packet, double scale) {
  constexpr double kEarthRadiusM = 6378137;
  const auto [latitude, longitude, altitude, roll, pitch, yaw] = packet;
  SE3 world_from_imu;
  world_from_imu.t = {scale * kEarthRadiusM * longitude * kRadPerDegree,
                      scale * kEarthRadiusM * std::log(std::tan((90 + latitude) * kRadPerDegree / 2)), altitude};
  world_from_imu.R = so3_exp({0, 0, yaw}) * so3_exp({0, pitch, 0}) * so3_exp({roll, 0, 0});
  return world_from_imu;
}

struct OxtsPacket {
  std::int64_t time_ns = 0;
  std::array<double, 6> values{};
  fs::path file;
};

double compute_mercator_scale(const OxtsPacket& first) { return std::cos(to_radians(first.values[0])); }

std::vector<StampedPose> to_mercator_poses(const std::vector<OxtsPacket>& packets, const SE3& imu_from_lidar) {
  std::vector<StampedPose> poses;
  const double scale = compute_mercator_scale(packets.front());
  for (const OxtsPacket& packet : packets)
    poses.push_back({packet.time_ns, to_mercator_pose(packet.values, scale) * imu_from_lidar});
  return poses;
}

// Removes outliers before the first packet sets the scale: a receiver without a fix writes arbitrary positions.
void leave_out_far_packets(Drive& drive, std::vector<OxtsPacket>& packets, const SE3& imu_from_lidar) {
  const PoseJumps jumps = find_pose_jumps(to_mercator_poses(packets, imu_from_lidar));
  if (jumps.outliers == 0) return;
  const auto first = std::find(jumps.outlier.begin(), jumps.outlier.end(), true) - jumps.outlier.begin();
  drive.warnings.push_back(
      fmt::format("{} of {} oxts packets are outliers, by up to {:.0f} m at the first jump, and are ignored (the first: {})",
                  jumps.outliers, packets.size(), jumps.first->distance_m,
                  fs::relative(packets[static_cast<std::size_t>(first)].file, drive.path).string()));
  std::vector<OxtsPacket> kept;
  for (std::size_t i = 0; i < packets.size(); ++i)
    if (!jumps.outlier[i]) kept.push_back(std::move(packets[i]));
  packets = std::move(kept);
}

void read_oxts(Drive& drive, const NumberedFiles& files) {
  if (files.empty()) return;
  const fs::path folder = drive.path / "oxts";
  const SE3 imu_from_lidar = read_lidar_from_imu(drive.path.parent_path()).inverse();
  const KittiStamps stamps(folder / "timestamps.txt");
  drive.other_files.insert(drive.other_files.end(),
                           {drive.path.parent_path() / "calib_imu_to_velo.txt", folder / "timestamps.txt"});
  std::vector<OxtsPacket> packets;
  for (const auto& [number, file] : files) {
    packets.push_back({stamps.of(number, file), read_packet(file), file});
    drive.other_files.push_back(file);
  }
  leave_out_far_packets(drive, packets, imu_from_lidar);
  drive.world_scale = compute_mercator_scale(packets.front());
  for (const OxtsPacket& packet : packets)
    drive.fixes.push_back({packet.time_ns, packet.values[0], packet.values[1], imu_from_lidar.inverse().t});
  drive.poses = Trajectory(to_mercator_poses(packets, imu_from_lidar));
}

std::vector<Gap> read_own_labels(Drive& drive) {
  std::vector<Gap> gaps;
  const fs::path tracking = drive.path / "tracking_labels.txt", tracklets = drive.path / "tracklet_labels.xml";
  const fs::path outlines = drive.path / "mots_instances.txt";
  if (fs::exists(tracking))
    gaps.push_back(labels::add_labels(drive, tracking));
  else if (fs::exists(tracklets))
    gaps.push_back(labels::add_labels(drive, tracklets));
  if (fs::exists(outlines) && drive.camera_name == "image_02") gaps.push_back(labels::add_labels(drive, outlines));
  return gaps;
}

// Expands "2" and "02" to "image_02".
std::string to_full_name(const std::string& camera) {
  return is_all_digits(camera) && camera.size() <= 2 ? "image_0" + camera.substr(camera.size() - 1) : camera;
}

// Refuses unrectified images. KITTI publishes each drive twice: as recorded (`_extract`, 1392x512 pixels) and rectified
// (`_sync`).
void require_rectified(const Drive& drive) {
  if (!drive.path.filename().string().ends_with("_extract")) return;
  const cv::Size size = media::image_size(drive.frames.front().file);
  if (size != cv::Size(drive.camera.width, drive.camera.height))
    throw InputError(drive.path,
                     fmt::format("holds images of {}x{} pixels as recorded, not rectified to {}x{}", size.width, size.height,
                                 drive.camera.width, drive.camera.height),
                     "download the drive whose name ends in _sync");
}

DriveContents read_kitti(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  drive.format = "kitti-raw";
  for (const char* camera : {"image_00", "image_01", "image_02", "image_03"})
    if (!list_images(path, camera).empty()) drive.camera_names.emplace_back(camera);
  if (drive.camera_names.empty()) throw InputError(path, "holds no images", "put them into image_02/data");
  drive.camera_name = choose_camera(drive, to_full_name(options.camera), "image_02");

  const KittiCalibration calibration = read_kitti_calibration(path.parent_path(), drive.camera_name);
  drive.camera = calibration.camera;
  drive.camera_from_lidar = calibration.camera_from_lidar();
  drive.box_camera_from_lidar = calibration.rect0_from_lidar;
  drive.other_files = calibration.files;
  drive.frames = read_frames(path, drive.camera_name);
  drive.other_files.push_back(path / drive.camera_name / "timestamps.txt");
  if (drive.camera.width == 0) {
    const cv::Size size = media::image_size(drive.frames.front().file);
    drive.camera.width = size.width, drive.camera.height = size.height;
  }
  require_rectified(drive);
  require_plausible(drive.camera, calibration.files.front(), "P_rect_" + drive.camera_name.substr(6));
  drive.scan_headers = read_scan_headers(path / "velodyne_points", drive.other_files);
  const NumberedFiles packets = list_numbered_files(path / "oxts" / "data", {".txt"});
  read_oxts(drive, packets);
  const NumberedFiles scans = list_numbered_files(path / "velodyne_points" / "data", {".bin"});
  recording.gaps = find_kitti_gaps(drive, list_images(path, drive.camera_name), scans, options);
  if (!recording.gaps.empty()) recording.gaps.push_back({"no oxts packet for frames", find_numbers_without(drive, packets)});

  Rotation rotation;  // the default is correct: clockwise, with the front in the middle of the scan
  LidarConfig lidar;
  if (const auto config = read_drive_config(path)) {
    config->apply(drive);
    lidar = config->lidar;
    rotation = lidar.rotation();
  }
  for (Gap& gap : read_own_labels(drive)) recording.gaps.push_back(std::move(gap));
  attach_scan_files(recording, lidar, rotation);
  return recording;
}

bool recognize_kitti(const fs::path& path) {
  const std::string name = path.filename().string();
  if (!fs::is_directory(path)) return false;
  if (name.find("_drive_") != std::string::npos && name.ends_with("_sync")) return true;
  const bool camera = fs::is_directory(path / "image_02" / "data") || fs::is_directory(path / "image_00" / "data");
  return camera && (fs::is_directory(path / "oxts") || fs::is_directory(path / "velodyne_points"));
}

}  // namespace

DriveFormat kitti_raw_format() {
  return {"kitti-raw",
          "2011_09_26/2011_09_26_drive_0001_sync with image_02/data; calib_*.txt beside it",
          recognize_kitti,
          read_kitti,
          {"image_02/data|image_00/data", "image_02/timestamps.txt|image_00/timestamps.txt", "velodyne_points/data",
           "oxts/data", "../calib_cam_to_cam.txt"},
          2};
}

}  // namespace dvi::datasets
