#include <algorithm>
#include <cmath>
#include <map>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/media/image_file.h"
#include "dvi/media/point_cloud.h"

namespace dvi::datasets {
namespace {

constexpr std::int64_t kScanPeriodNs = 100'000'000;  // nanoseconds
constexpr const char* kCamera = "front";             // the layout has one camera, without a name

// The LiDAR axes of the files are x left, y back, z up. Their poses use those of LOAM: back, up, left.
const Eigen::Matrix3d kLidarFromNative = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
const Eigen::Matrix3d kLoamFromNative = (Eigen::Matrix3d() << 0, 1, 0, 0, 0, 1, 1, 0, 0).finished();

// Sets the calibration of the Pandora of the published recordings; its images are assumed to be free of distortion.
void calibrate(Drive& drive) {
  drive.camera.fx = 1477.504983559334, drive.camera.fy = 1464.34160012337;
  drive.camera.cx = 602.1210058502093, drive.camera.cy = 342.1011293729023;
  const Eigen::Quaterniond q(-0.007226328651958486, 0.00177378227135296, -0.7087850442558459, 0.705385281183203);
  const SE3 native_from_camera{q.normalized().toRotationMatrix(),
                               {0.001476393536454348, -0.03503004858621427, -0.1188303720275153}};
  drive.camera_from_lidar = (SE3{kLidarFromNative, {0, 0, 0}} * native_from_camera).inverse();
}

bool is_span(const std::string& name) {
  const std::size_t dash = name.find('-');
  return dash != std::string::npos && is_all_digits(name.substr(0, dash)) && is_all_digits(name.substr(dash + 1));
}

// Lists the folders T0-T1 or T0-T1_mask in order.
std::vector<fs::path> list_span_folders(const fs::path& path, const std::string& suffix) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && name.ends_with(suffix) && is_span(name.substr(0, name.size() - suffix.size())))
      folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

std::int64_t parse_time(const fs::path& file, const std::string& name) {
  if (const auto time = to_nanoseconds(name)) return *time;
  throw InputError(file, "is not named by its time in seconds", "name it like 1534313591.532.jpg");
}

// Turns "lidar_bg/bg_1534313591.532032.pcd.ply" into "1534313591.532032".
std::string find_scan_name(const std::string& file) {
  std::string name = fs::path(file).filename().string();
  name = name.substr(0, name.find(".p"));
  return name.starts_with("bg_") ? name.substr(3) : name;
}

std::vector<Frame> read_frames(const std::vector<fs::path>& folders) {
  std::map<std::int64_t, fs::path> images;
  for (const fs::path& folder : folders)
    for (const fs::path& file : list_files(folder, {".jpg", ".jpeg"}))
      images.emplace(parse_time(file, file.stem().string()), file);
  std::vector<Frame> frames;
  for (const auto& [time, file] : images)
    frames.push_back({static_cast<int>(frames.size()), file.stem().string(), time, file, {}});
  return frames;
}

std::vector<ScanHeader> read_scan_headers(const fs::path& folder) {
  std::vector<ScanHeader> scan_headers;
  for (const fs::path& file : list_files(folder, {".ply"})) {
    const std::string name = find_scan_name(file.string());
    const std::int64_t end = parse_time(file, name);
    scan_headers.push_back({name, end - kScanPeriodNs / 2, end - kScanPeriodNs, end, file});
  }
  std::sort(scan_headers.begin(), scan_headers.end(),
            [](const ScanHeader& a, const ScanHeader& b) { return a.time_ns < b.time_ns; });
  return scan_headers;
}

Eigen::Matrix3d rotate(const Eigen::Vector3d& axis, double angle) { return so3_exp(angle * axis); }

// Reads lines "NAME rx ry rz x y z". `compose` multiplies the rotations in the order of that file.
template <class Compose>
std::map<std::int64_t, SE3> read_pose_lines(const fs::path& file, const Compose& compose) {
  std::map<std::int64_t, SE3> poses;
  for (const TextLine& line : read_text_lines(file)) {
    const auto end = to_nanoseconds(find_scan_name(line.word(0)));
    if (!end) line.fail("'" + line.word(0) + "' does not name a scan by its time");
    const auto v = line.numbers<6>(1);
    poses[*end] = {compose(rotate(Eigen::Vector3d::UnitX(), v[0]), rotate(Eigen::Vector3d::UnitY(), v[1]),
                           rotate(Eigen::Vector3d::UnitZ(), v[2])),
                   {v[3], v[4], v[5]}};
  }
  return poses;
}

// A scan is described by a pose at its start and one at its end. The end of a scan is the start of the next one, so only the
// first scan and those after a gap need a pose at their start.
std::vector<StampedPose> read_span_poses(const fs::path& folder, std::vector<fs::path>& other_files) {
  const SE3 lidar_from_loam{kLidarFromNative * kLoamFromNative.transpose(), {0, 0, 0}};
  const fs::path global = folder / "global_poses.txt", relative = folder / "rel_poses.txt";
  if (!fs::exists(global)) return {};
  const auto map_from_end = read_pose_lines(global, [](const auto& X, const auto& Y, const auto& Z) { return Y * X * Z; });
  other_files.push_back(global);
  std::vector<StampedPose> poses;
  const auto add = [&](std::int64_t time, const SE3& map_from_lidar) {
    poses.push_back({time, lidar_from_loam * map_from_lidar * lidar_from_loam.inverse()});
  };
  for (const auto& [end, pose] : map_from_end) add(end, pose);
  if (!fs::exists(relative)) return poses;
  const auto end_from_start = read_pose_lines(relative, [](const auto& X, const auto& Y, const auto& Z) { return Z * X * Y; });
  other_files.push_back(relative);
  for (const auto& [end, motion] : end_from_start) {
    const auto pose = map_from_end.find(end);
    const auto before = map_from_end.lower_bound(end - kScanPeriodNs * 3 / 2);
    if (pose != map_from_end.end() && before->first == end) add(end - kScanPeriodNs, pose->second * motion);
  }
  return poses;
}

Gap find_frames_without_scan(const Drive& drive) {
  Gap gap{"no scan for frames", {}};
  for (const Frame& frame : drive.frames)
    if (std::none_of(drive.scan_headers.begin(), drive.scan_headers.end(),
                     [&](const ScanHeader& header) { return std::abs(header.start_ns - frame.time_ns) <= kScanPeriodNs / 2; }))
      gap.frames.push_back(frame.number);
  return gap;
}

Scan read_scan(const ScanHeader& header) {
  media::PointCloud cloud = media::read_point_cloud(header.file);
  Scan scan;
  scan.time = times_in_order(cloud.points, header);
  const Eigen::Matrix3f R = kLidarFromNative.cast<float>();
  for (Eigen::Vector3f& p : cloud.points) p = R * p;
  scan.points = std::move(cloud.points);
  scan.intensity = std::move(cloud.intensity);
  scan.ring = std::move(cloud.ring);
  scan.file_points = cloud.file_points;
  scan.file_index = std::move(cloud.file_index);
  return scan;
}

DriveContents read_apolloscape(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  drive.camera_names = {kCamera};
  drive.camera_name = choose_camera(drive, options.camera, kCamera);
  const std::vector<fs::path> mask_folders = list_span_folders(path, "_mask");
  std::vector<fs::path> image_folders = mask_folders;
  image_folders.insert(image_folders.begin(), path / "image");
  drive.frames = read_frames(image_folders);
  if (drive.frames.empty()) throw InputError(path, "holds no images", "put them into image/, named T.jpg");
  labels::match_masks(drive, mask_folders);
  drive.scan_headers = read_scan_headers(path / "lidar_bg");
  calibrate(drive);
  const cv::Size size = media::image_size(drive.frames.front().file);
  drive.camera.width = size.width, drive.camera.height = size.height;

  std::vector<StampedPose> poses;
  for (const fs::path& folder : list_span_folders(path, "")) {
    const auto more = read_span_poses(folder, drive.other_files);
    poses.insert(poses.end(), more.begin(), more.end());
  }
  drive.poses = Trajectory(std::move(poses));
  recording.gaps = {find_frames_without_scan(drive)};
  if (const auto config = read_drive_config(path)) config->apply(drive);
  recording.read_scan = read_scan;
  return recording;
}

bool recognize_apolloscape(const fs::path& path) {
  return fs::is_directory(path / "lidar_bg") &&
         !(list_span_folders(path, "").empty() && list_span_folders(path, "_mask").empty());
}

}  // namespace

DriveFormat apolloscape_format() {
  return {"apolloscape",
          "lidar_bg, T0-T1 and T0-T1_mask beside each other, image/T.jpg",
          recognize_apolloscape,
          read_apolloscape,
          {"lidar_bg", "image"}};
}

}  // namespace dvi::datasets
