#include "dvi/datasets/kitti_calibration.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/geometry/plausible.h"
#include "dvi/geometry/rigid.h"

namespace dvi::datasets {
namespace {

constexpr const char* kPublished360 = "use the file as published by KITTI-360";

// The lines "KEY: numbers" of a file.
class Entries {
 public:
  explicit Entries(const fs::path& file) : file_(file) {
    if (!fs::exists(file)) throw InputError(file, "is missing", "download the calibration files of that day from KITTI");
    for (const TextLine& line : read_text_lines(file))
      if (line.size() > 0) lines_.emplace(line.word(0), line);
  }
  bool has(const std::string& key) const { return lines_.contains(key + ":"); }
  template <std::size_t N>
  std::array<double, N> numbers(const std::string& key) const {
    const auto line = lines_.find(key + ":");
    if (line == lines_.end()) throw InputError(file_, "has no entry " + key, "use the file as published by KITTI");
    if (line->second.size() != N + 1) line->second.fail(key + " does not have " + std::to_string(N) + " numbers");
    return line->second.numbers<N>(1);
  }
  Eigen::Matrix3d matrix(const std::string& key) const {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers<9>(key).data());
  }
  Eigen::Matrix3d rotation(const std::string& key) const {
    const Eigen::Matrix3d R = matrix(key);
    const std::string problem = describe_rotation_problem(R);
    if (!problem.empty()) throw InputError(file_, key + " " + problem, "use the file as published by KITTI");
    return nearest_rotation(R);
  }
  SE3 rigid() const {
    const auto t = numbers<3>("T");
    return {rotation("R"), {t[0], t[1], t[2]}};
  }

 private:
  fs::path file_;
  std::map<std::string, TextLine> lines_;
};

// Returns camera and camera_from_rect0 of a projection P = K [I | t], where K t is the last column of P.
KittiCalibration to_calibration(const std::array<double, 12>& P, const fs::path& file, const std::string& entry) {
  KittiCalibration out;
  out.camera.fx = P[0], out.camera.cx = P[2], out.camera.fy = P[5], out.camera.cy = P[6];
  const std::array<double, 9> K = {P[0], P[1], P[2], P[4], P[5], P[6], P[8], P[9], P[10]};
  if (const std::string problem = describe_camera_matrix_problem(K); !problem.empty())
    throw InputError(file, entry + " " + problem);
  out.camera_from_rect0.t = {(P[3] - P[2] * P[11]) / P[0], (P[7] - P[6] * P[11]) / P[5], P[11]};
  return out;
}

void read_size(const Entries& entries, const std::string& entry, const fs::path& file, Camera& camera) {
  if (!entries.has(entry)) return;
  const auto size = entries.numbers<2>(entry);
  for (const double side : size)
    if (!(side >= 1 && side <= 1 << 20)) throw InputError(file, entry + " is not the width and height of an image in pixels");
  camera.width = static_cast<int>(size[0]), camera.height = static_cast<int>(size[1]);
}

SE3 require_rigid(const std::array<double, 12>& numbers, const fs::path& file, const std::string& entry) {
  if (const auto motion = to_rigid(numbers)) return *motion;
  throw InputError(file, entry + " " + describe_rotation_problem(get_left_part(numbers)), "use the file as published by KITTI");
}

double read_number(const cv::FileNode& parent, const char* name, const fs::path& file) {
  const cv::FileNode node = parent[name];
  if (!node.isReal() && !node.isInt()) throw InputError(file, fmt::format("has no number {}", name), kPublished360);
  return static_cast<double>(node);
}

// Reads the calibration of a camera of the unified model, a YAML file of OpenCV.
Camera read_unified_camera(const fs::path& file) {
  if (!fs::exists(file)) throw InputError(file, "is missing", "download it with KITTI-360's calibration files");
  try {
    const cv::FileStorage storage(read_file(file), cv::FileStorage::READ | cv::FileStorage::MEMORY);
    const cv::FileNode root = storage.root(), distortion = root["distortion_parameters"], K = root["projection_parameters"];
    Camera out;
    out.width = static_cast<int>(std::clamp(read_number(root, "image_width", file), 0.0, 1e6));
    out.height = static_cast<int>(std::clamp(read_number(root, "image_height", file), 0.0, 1e6));
    out.fx = read_number(K, "gamma1", file), out.fy = read_number(K, "gamma2", file);
    out.cx = read_number(K, "u0", file), out.cy = read_number(K, "v0", file);
    std::vector<double> coefficients;
    for (const char* name : {"k1", "k2", "p1", "p2"}) coefficients.push_back(read_number(distortion, name, file));
    out.set_lens(make_lens(CameraModel::unified, coefficients, read_number(root["mirror_parameters"], "xi", file)));
    return out;
  } catch (const cv::Exception& e) {
    throw InputError(file, fmt::format("is not a YAML file of OpenCV ({})", e.err), kPublished360);
  }
}

KittiCalibration read_fisheye_calibration(const fs::path& folder, const std::string& camera) {
  const fs::path to_pose = folder / "calib_cam_to_pose.txt", lens = folder / (camera + ".yaml");
  KittiCalibration out = read_kitti_360_calibration(folder, "image_00");
  out.camera = read_unified_camera(lens);
  const SE3 imu_from_camera0 = read_kitti_360_camera_pose(to_pose, "image_00");
  out.camera_from_rect0 =
      read_kitti_360_camera_pose(to_pose, camera).inverse() * imu_from_camera0 * SE3{out.rect0_rotation.transpose(), {0, 0, 0}};
  out.files.insert(out.files.end(), {to_pose, lens});
  return out;
}

}  // namespace

bool is_kitti_360_fisheye(const std::string& camera) { return camera == "image_02" || camera == "image_03"; }

KittiCalibration read_kitti_calibration(const fs::path& date_folder, const std::string& camera) {
  const fs::path cam_to_cam = date_folder / "calib_cam_to_cam.txt", velo_to_cam = date_folder / "calib_velo_to_cam.txt";
  const std::string number = camera.substr(camera.size() - 2);
  const Entries cameras(cam_to_cam), lidar(velo_to_cam);
  KittiCalibration out = to_calibration(cameras.numbers<12>("P_rect_" + number), cam_to_cam, "P_rect_" + number);
  out.files = {cam_to_cam, velo_to_cam};
  read_size(cameras, "S_rect_" + number, cam_to_cam, out.camera);
  out.rect0_from_lidar = SE3{cameras.rotation("R_rect_00"), {0, 0, 0}} * lidar.rigid();
  return out;
}

KittiCalibration read_kitti_odometry_calibration(const fs::path& file, const std::string& camera) {
  const Entries entries(file);
  const std::string entry = "P" + camera.substr(camera.size() - 1);
  KittiCalibration out = to_calibration(entries.numbers<12>(entry), file, entry);
  out.files = {file};
  if (!entries.has("Tr"))
    throw InputError(file, "has no entry Tr, the pose of the LiDAR", "use calib.txt of the benchmark's velodyne data");
  out.rect0_from_lidar = require_rigid(entries.numbers<12>("Tr"), file, "Tr");
  return out;
}

SE3 read_kitti_360_camera_pose(const fs::path& file, const std::string& camera) {
  if (!fs::exists(file)) throw InputError(file, "is missing", "download it with KITTI-360's calibration files");
  for (const TextLine& line : read_text_lines(file))
    if (line.size() > 0 && line.word(0) == camera + ":") return require_rigid(line.numbers<12>(1), file, camera);
  throw InputError(file, "has no entry " + camera, "use the file as published by KITTI-360");
}

KittiCalibration read_kitti_360_calibration(const fs::path& folder, const std::string& camera) {
  if (is_kitti_360_fisheye(camera)) return read_fisheye_calibration(folder, camera);
  const fs::path perspective = folder / "perspective.txt", to_velo = folder / "calib_cam_to_velo.txt";
  const std::string number = camera.substr(camera.size() - 2);
  const Entries cameras(perspective);
  KittiCalibration out = to_calibration(cameras.numbers<12>("P_rect_" + number), perspective, "P_rect_" + number);
  out.files = {perspective, to_velo};
  read_size(cameras, "S_rect_" + number, perspective, out.camera);
  if (!fs::exists(to_velo)) throw InputError(to_velo, "is missing", "download it with KITTI-360's calibration files");
  const std::vector<TextLine> lines = read_text_lines(to_velo);
  if (lines.empty()) throw InputError(to_velo, "is empty", "use the file as published by KITTI-360");
  const SE3 lidar_from_camera0 = require_rigid(lines.front().numbers<12>(0), to_velo, "its matrix");
  out.rect0_rotation = cameras.rotation("R_rect_00");
  out.rect0_from_lidar = SE3{out.rect0_rotation, {0, 0, 0}} * lidar_from_camera0.inverse();
  return out;
}

SE3 read_lidar_from_imu(const fs::path& date_folder) { return Entries(date_folder / "calib_imu_to_velo.txt").rigid(); }

}  // namespace dvi::datasets
