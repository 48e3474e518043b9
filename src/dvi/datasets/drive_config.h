#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/datasets/depth_scan.h"
#include "dvi/datasets/scan_time.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// What a table [camera.NAME] of a drive's dvi.toml says; what it leaves out is none.
struct CameraConfig {
  std::optional<cv::Size> size;
  std::optional<std::array<double, 9>> K;  ///< row-major
  std::optional<std::array<double, 5>> distortion;
  std::optional<SE3> camera_from_lidar;
  std::int64_t offset_ns = 0;  ///< added to the camera's stamps

  void apply(Drive& drive) const;  ///< to camera, camera_from_lidar and the frames' times
};

/// What the table [lidar] says.
struct LidarConfig {
  double rate = 10;  ///< scans a second
  std::optional<Sensor> sensor;
  enum class Stamp { start, middle, end } stamp = Stamp::middle;
  std::optional<Turn> turn;
  std::optional<double> first_azimuth;  ///< radians
  std::int64_t offset_ns = 0;           ///< added to the LiDAR's stamps
  std::vector<std::string> columns;     ///< of .bin files; empty: inferred
  double units_per_meter = 1;           ///< of coordinates in scan files

  void apply(Drive& drive) const;  ///< to the sensor and the scans' times
  Rotation rotation() const { return {turn.value_or(Turn::clockwise), first_azimuth.value_or(std::numbers::pi)}; }
};

/// What the table [depth] says of the camera that took the depth images.
struct DepthConfig {
  std::optional<std::array<double, 9>> K;  ///< row-major
  std::optional<std::array<double, 5>> distortion;
  std::optional<SE3> depth_from_color;
  std::optional<double> units_per_meter;

  void apply(DepthCamera& depth) const;
};

/// A drive's dvi.toml: calibration and clocks. `folder` is made of it; in a drive of any other format it overrides.
struct DriveConfig {
  fs::path file;
  std::map<std::string, CameraConfig> cameras;
  std::string usual_camera;  ///< which is used where none is asked for; empty: the first
  LidarConfig lidar;
  DepthConfig depth;

  /// What is said of a camera; nothing, if it is not there.
  CameraConfig camera(const std::string& name) const;
  /// Overrides calibration and clocks of a drive of another format, and notes the file.
  void apply(Drive& drive) const;
  /// InputError where it made the drive's camera one that cannot be.
  void require_plausible(const Drive& drive) const;
};

/// Reads DRIVE/dvi.toml; none where there is no such file. InputError where it is malformed, has keys that are not known, or
/// is of another version.
std::optional<DriveConfig> read_drive_config(const fs::path& drive);

}  // namespace dvi::datasets
