#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/datasets/camera_choice.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/file_names.h"
#include "dvi/datasets/kitti_calibration.h"
#include "dvi/datasets/kitti_files.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/scan_files.h"
#include "dvi/geometry/plausible.h"
#include "dvi/geometry/rigid.h"
#include "dvi/media/image_file.h"

namespace dvi::datasets {
namespace {

constexpr std::int64_t kHalfRevolutionNs = 50'000'000;  // at 10 Hz

// The folders of one drive of the data set.
struct Kitti360Paths {
  fs::path images, calibration, scans, poses, boxes, labels_2d;

  explicit Kitti360Paths(const fs::path& drive) : images(drive) {
    const fs::path root = drive.parent_path().parent_path();
    const std::string name = drive.filename().string();
    calibration = root / "calibration";
    scans = root / "data_3d_raw" / name / "velodyne_points";
    poses = root / "data_poses" / name / "poses.txt";
    for (const char* part : {"train", "test"}) {
      if (const fs::path file = root / "data_3d_bboxes" / part / (name + ".xml"); fs::exists(file)) boxes = file;
      if (const fs::path folder = root / "data_2d_semantics" / part / name; fs::is_directory(folder)) labels_2d = folder;
    }
  }
};

// The perspective cameras have rectified images, the fisheye cameras those as recorded.
fs::path find_image_folder(const fs::path& drive, const std::string& camera) {
  return drive / camera / (is_kitti_360_fisheye(camera) ? "data_rgb" : "data_rect");
}

NumberedFiles list_camera_images(const fs::path& drive, const std::string& camera) {
  return list_numbered_files(find_image_folder(drive, camera), kImageEndings);
}

// The times of a drive's images and scans. Copied excerpts often have the timestamps.txt of another excerpt. If that of the
// images or of the scans has no line for any of them, the times of both are counted by their numbers.
class Kitti360Clock {
 public:
  struct Sensor {
    const NumberedFiles* files;
    fs::path stamps;
  };
  Kitti360Clock(const Sensor& images, const Sensor& scans, Drive& drive) : images_(images.stamps) {
    if (!scans.files->empty()) scans_.emplace(scans.stamps);
    for (const Sensor* sensor : {&images, &scans}) {
      if (sensor->files->empty()) continue;
      drive.other_files.push_back(sensor->stamps);
      count_if_short(*sensor, sensor == &images ? images_ : *scans_, drive);
    }
  }
  std::int64_t of_image(int number, const fs::path& data) const {
    return step_ns_ ? number * *step_ns_ : images_.of(number, data);
  }
  std::int64_t of_scan(int number, const fs::path& data) const {
    return step_ns_ ? number * *step_ns_ : scans_->of(number, data);
  }

 private:
  void count_if_short(const Sensor& sensor, const KittiStamps& stamps, Drive& drive) {
    const auto& [first, file] = *sensor.files->begin();
    if (std::cmp_less(first, stamps.size()) || step_ns_) return;
    step_ns_ = stamps.mean_step_ns();
    drive.warnings.push_back(fmt::format(
        "{} has {} lines and none for {}: it belongs to another excerpt. The times of images and scans are counted by "
        "their numbers, {:.4f} s apart",
        sensor.stamps.string(), stamps.size(), file.filename().string(), 1e-9 * static_cast<double>(*step_ns_)));
  }

  KittiStamps images_;
  std::optional<KittiStamps> scans_;
  std::optional<std::int64_t> step_ns_;  // if times are counted
};

// Reads lines "frame r r r t ...": world_from_imu of the frames in which the vehicle moved.
Trajectory read_imu_poses(const fs::path& file, const Kitti360Clock& clock, const SE3& imu_from_lidar) {
  std::vector<StampedPose> poses;
  for (const TextLine& line : read_text_lines(file)) {
    const auto numbers = line.numbers<12>(1);
    const std::optional<SE3> world_from_imu = to_rigid(numbers);
    if (!world_from_imu)
      line.fail(describe_rotation_problem(get_left_part(numbers)), "lines are: frame, then a 3x4 matrix row by row");
    poses.push_back({clock.of_image(line.integer(0), file), *world_from_imu * imu_from_lidar});
  }
  return Trajectory(std::move(poses));
}

// Returns whether a class is of traffic, parked or not. The data set has boxes of buildings, poles and the ground as well.
bool is_traffic(const std::string& type) {
  static const std::set<std::string> types = {"car",     "truck",          "bus",     "train",  "caravan",
                                              "trailer", "motorcycle",     "bicycle", "person", "pedestrian",
                                              "rider",   "unknownvehicle", "van"};
  return types.contains(type);
}

// One box of the file in world axes. A moving object has one box per frame.
struct WorldBox {
  int track = -1, first_frame = 0, last_frame = 0;
  std::string type;
  Box box;
};

class BoxReader {
 public:
  explicit BoxReader(const fs::path& file) : file_(file) {}

  std::vector<WorldBox> read() {
    pugi::xml_document document;
    const std::string text = read_file(file_);
    if (const auto result = document.load_buffer(text.data(), text.size()); !result)
      throw InputError(file_, fmt::format("is not valid XML at byte {} ({})", result.offset, result.description()));
    std::vector<WorldBox> boxes;
    for (const pugi::xml_node& object : document.child("opencv_storage").children())
      if (object.child("transform"))
        if (auto box = read(object)) boxes.push_back(std::move(*box));
    return boxes;
  }

 private:
  std::optional<WorldBox> read(const pugi::xml_node& object) {
    WorldBox out;
    out.type = to_lower_case(object.child_value("label"));
    if (!is_traffic(out.type)) return std::nullopt;
    const int timestamp = integer(object, "timestamp");
    const bool moves = timestamp >= 0;
    out.first_frame = moves ? timestamp : object.child("start_frame") ? integer(object, "start_frame") : 0;
    out.last_frame = moves                       ? timestamp
                     : object.child("end_frame") ? integer(object, "end_frame")
                                                 : std::numeric_limits<int>::max();
    // All boxes of a moving object have the same instance; each parked object has a box of its own.
    out.track = moves && object.child("instanceId") ? integer(object, "instanceId") : track(1'000'000, object, "index");
    if (moves && object.child("dynamicSeq")) out.track = track(500'000, object, "dynamicSeq");
    out.box = box(object);
    return out;
  }

  // The columns of the transform are the box's axes, multiplied by the scale of `vertices`.
  Box box(const pugi::xml_node& object) {
    const std::vector<double> m = matrix(object, "transform"), v = matrix(object, "vertices");
    if (m.size() != 16 || v.size() < 6 || v.size() % 3 != 0)
      fail(object, "has no transform of 4x4 and vertices of Nx3 numbers");
    Eigen::Matrix3d scaled;
    Eigen::Vector3d center, low(v[0], v[1], v[2]), high = low;
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> transform(m.data());
    scaled = transform.leftCols<3>();
    center = transform.col(3);
    for (std::size_t i = 0; i < v.size(); i += 3) {
      const Eigen::Vector3d vertex(v[i], v[i + 1], v[i + 2]);
      low = low.cwiseMin(vertex), high = high.cwiseMax(vertex);
    }
    Box out;
    Eigen::Matrix3d axes = scaled;
    for (int axis = 0; axis < 3; ++axis) {
      const double length = scaled.col(axis).norm();
      out.size[axis] = length * (high - low)[axis];
      if (!(out.size[axis] > 0)) fail(object, "is a box of size 0");
      axes.col(axis) /= length;
    }
    if (axes.determinant() < 0) axes.col(2) *= -1;
    out.frame_from_box = {nearest_rotation(axes), scaled * (0.5 * (low + high)) + center};
    require_near(out.frame_from_box.t, file_, "a box");
    return out;
  }

  int integer(const pugi::xml_node& object, const char* name) {
    if (const auto value = to_integer(object.child_value(name))) return *value;
    fail(object, fmt::format("has no whole number '{}'", name));
  }
  // Returns the number of an object in a range of its own, which begins at `first`.
  int track(int first, const pugi::xml_node& object, const char* name) {
    const int number = integer(object, name);
    if (number < 0 || number > std::numeric_limits<int>::max() - first)
      fail(object, fmt::format("has the {} {}, which is not the number of an object", name, number));
    return first + number;
  }
  std::vector<double> matrix(const pugi::xml_node& object, const char* name) {
    std::vector<double> numbers;
    std::string text = object.child(name).child_value("data");
    std::replace(text.begin(), text.end(), '\n', ' ');
    for (const std::string& word : split_words(text)) {
      const auto number = to_number(word);
      if (!number) fail(object, fmt::format("'{}' in its {} is not a number", word, name));
      numbers.push_back(*number);
    }
    return numbers;
  }
  [[noreturn]] void fail(const pugi::xml_node& object, const std::string& problem) {
    throw InputError(file_, fmt::format("{} {}", object.name(), problem), "use the file as published by KITTI-360");
  }

  fs::path file_;
};

void add_boxes(Drive& drive, const fs::path& file) {
  constexpr double kMaxDistanceM = 120;  // beyond the range of scans
  const std::vector<WorldBox> boxes = BoxReader(file).read();
  for (Frame& frame : drive.frames) {
    const auto world_from_lidar = drive.poses.at(frame.time_ns);
    if (!world_from_lidar) continue;
    const SE3 lidar_from_world = world_from_lidar->inverse();
    for (const WorldBox& box : boxes) {
      if (frame.number < box.first_frame || frame.number > box.last_frame) continue;
      const Box here{lidar_from_world * box.box.frame_from_box, box.box.size};
      if (here.frame_from_box.t.norm() > kMaxDistanceM) continue;
      frame.labels.push_back({.track = box.track, .type = box.type, .box = here, .rect = {}, .instance = {}});
    }
  }
  drive.labeled = drive.labeled_around = true;
  drive.other_files.push_back(file);
}

void set_times(Drive& drive, const Kitti360Clock& clock, const NumberedFiles& images, const NumberedFiles& scans) {
  for (const auto& [number, file] : images)
    drive.frames.push_back({number, file.stem().string(), clock.of_image(number, file), file, {}});
  for (const auto& [number, file] : scans) {
    const std::int64_t time = clock.of_scan(number, file);
    drive.scan_headers.push_back({file.stem().string(), time, time - kHalfRevolutionNs, time + kHalfRevolutionNs, file});
  }
}

DriveContents read_kitti_360(const fs::path& path, const ReadOptions& options) {
  DriveContents recording;
  Drive& drive = recording.drive;
  drive.path = path;
  const Kitti360Paths places(path);
  for (const char* camera : {"image_00", "image_01", "image_02", "image_03"})
    if (!list_camera_images(path, camera).empty()) drive.camera_names.emplace_back(camera);
  if (drive.camera_names.empty())
    fail_without_images(path / "image_00/data_rect", "holds no images", "put them into image_00/data_rect");
  drive.camera_name = choose_camera(drive, options.camera, "image_00");

  const KittiCalibration calibration = read_kitti_360_calibration(places.calibration, drive.camera_name);
  drive.camera = calibration.camera;
  drive.camera_from_lidar = calibration.camera_from_lidar();
  drive.other_files = calibration.files;
  const NumberedFiles images = list_camera_images(path, drive.camera_name),
                      scans = list_numbered_files(places.scans / "data", {".bin"});
  const Kitti360Clock clock({&images, path / drive.camera_name / "timestamps.txt"}, {&scans, places.scans / "timestamps.txt"},
                            drive);
  set_times(drive, clock, images, scans);
  if (drive.camera.width == 0) {
    const cv::Size size = media::image_size(drive.frames.front().file);
    drive.camera.width = size.width, drive.camera.height = size.height;
  }
  const bool is_fisheye = is_kitti_360_fisheye(drive.camera_name);
  require_plausible(drive.camera, is_fisheye ? calibration.files.back() : calibration.files.front(),
                    is_fisheye ? drive.camera_name : "P_rect_" + drive.camera_name.substr(6));
  if (fs::exists(places.poses)) {
    const fs::path to_pose = places.calibration / "calib_cam_to_pose.txt";
    // calib_cam_to_velo is of the unrectified camera 0, rect0_from_lidar of the rectified one.
    const SE3 camera0_from_lidar = SE3{calibration.rect0_rotation.transpose(), {0, 0, 0}} * calibration.rect0_from_lidar;
    drive.poses = read_imu_poses(places.poses, clock, read_kitti_360_camera_pose(to_pose, "image_00") * camera0_from_lidar);
    drive.other_files.insert(drive.other_files.end(), {to_pose, places.poses});
  }
  recording.gaps = find_kitti_gaps(drive, images, scans, options);
  Rotation rotation;  // the default is correct: clockwise, with the front in the middle of the scan
  LidarConfig lidar;
  if (const auto config = read_drive_config(path)) {
    config->apply(drive);
    lidar = config->lidar;
    rotation = lidar.rotation();
  }
  if (!places.boxes.empty() && !drive.poses.empty())
    add_boxes(drive, places.boxes);
  else if (!places.labels_2d.empty() && !is_fisheye)
    drive.warnings.push_back(
        fmt::format("the instance images are not used; to use them, give --masks {} --classes car,truck,bus,person,rider",
                    (places.labels_2d / drive.camera_name / "instance").string()));
  attach_scan_files(recording, lidar, rotation);
  return recording;
}

bool recognize_kitti_360(const fs::path& path) {
  return fs::is_directory(path / "image_00/data_rect") || fs::is_directory(path / "image_01/data_rect") ||
         fs::is_directory(path / "image_02/data_rgb") || fs::is_directory(path / "image_03/data_rgb");
}

}  // namespace

DriveFormat kitti_360_format() {
  return {"kitti-360",
          "data_2d_raw/2013_05_28_drive_0000_sync with image_00/data_rect or image_02/data_rgb; calibration and data_3d_raw "
          "beside data_2d_raw",
          recognize_kitti_360,
          read_kitti_360,
          {"image_00/data_rect|image_01/data_rect|image_02/data_rgb|image_03/data_rgb", "image_00/timestamps.txt",
           "../../calibration/perspective.txt"},
          2};
}

}  // namespace dvi::datasets
