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

/// The table [camera.NAME] of a drive's dvi.toml. Missing entries have no value.
struct CameraConfig {
  std::optional<cv::Size> size;
  std::optional<std::array<double, 9>> K;  ///< row-major
  std::optional<Lens> lens;
  std::optional<SE3> camera_from_lidar;
  std::int64_t offset_ns = 0;  ///< is added to the camera's stamps

  /// Overrides the drive's camera, its `camera_from_lidar`, and the times of its frames.
  void apply(Drive& drive) const;
};

/// The table [lidar] of a drive's dvi.toml.
struct LidarConfig {
  double rate = 10;  ///< scans per second
  std::optional<Sensor> sensor;
  enum class Stamp { start, middle, end } stamp = Stamp::middle;
  std::optional<Turn> turn;
  std::optional<double> first_azimuth;  ///< radians
  std::int64_t offset_ns = 0;           ///< is added to the LiDAR's stamps
  std::vector<std::string> columns;     ///< of .bin files; empty: inferred
  double units_per_meter = 1;           ///< of coordinates in scan files

  /// Overrides the drive's sensor and the times of its scans.
  void apply(Drive& drive) const;
  Rotation rotation() const { return {turn.value_or(Turn::clockwise), first_azimuth.value_or(std::numbers::pi)}; }
};

/// The table [depth]: the camera that took the depth images.
struct DepthConfig {
  std::optional<std::array<double, 9>> K;  ///< row-major
  std::optional<Lens> lens;
  std::optional<SE3> depth_from_color;
  std::optional<double> units_per_meter;

  void apply(DepthCamera& depth) const;
};

/// A drive's dvi.toml: calibration and clocks. The `folder` layout requires it; in all other formats it overrides the
/// calibration of the recording.
struct DriveConfig {
  fs::path file;
  std::map<std::string, CameraConfig> cameras;
  std::string usual_camera;  ///< is used if no camera is requested; empty: the first one
  LidarConfig lidar;
  DepthConfig depth;

  /// Returns the table of a camera; an empty one if there is none.
  CameraConfig camera(const std::string& name) const;
  /// Overrides the calibration and clocks of a drive of another format, and adds the file to the drive's files.
  void apply(Drive& drive) const;
  /// Throws InputError if the drive's camera is implausible because of this file.
  void require_plausible(const Drive& drive) const;
};

/// Reads DRIVE/dvi.toml. Returns nothing if there is no such file. Throws InputError if it is malformed, has unknown keys, or
/// has another version.
std::optional<DriveConfig> read_drive_config(const fs::path& drive);

}  // namespace dvi::datasets
