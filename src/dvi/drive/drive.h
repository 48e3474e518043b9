#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/lazy.h"
#include "dvi/drive/given_map.h"
#include "dvi/drive/label.h"
#include "dvi/drive/scan.h"
#include "dvi/drive/sensor.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/earth_place.h"
#include "dvi/geometry/trajectory.h"

namespace dvi {

/// One image of the drive's chosen camera.
struct Frame {
  int number = 0;    ///< the drive's own number, as --frames takes it
  std::string name;  ///< the image's file name without its ending
  std::int64_t time_ns = 0;
  std::filesystem::path file;
  std::vector<Label> labels;
};

/// What is known of a scan, one revolution of the LiDAR, before its points are read. Its stamp is the middle of the scan.
struct ScanHeader {
  std::string name;
  std::int64_t time_ns = 0, start_ns = 0, end_ns = 0;
  std::filesystem::path file;
};

/// The camera of depth images, and how they are to be read.
struct DepthImages {
  Camera camera;
  std::optional<SE3> depth_from_color;  ///< none: registered, their pixels are those of the images
  double units_per_meter = 1000;
};

/// One stream of a bag.
struct RecordedTopic {
  std::string name, type;
  std::size_t messages = 0;
  double rate_hz = 0;
  std::string use;  ///< what it is taken for: "images of front"; empty: for nothing
};

/// A recording: what a reader found in a folder. Images, scans and masks are read on demand and cached within bounds.
struct Drive {
  std::filesystem::path path;
  std::string format;
  std::string camera_name;
  Camera camera;
  SE3 camera_from_lidar;
  /// The camera in whose axes label files of KITTI give their boxes; none: the drive's camera.
  std::optional<SE3> box_camera_from_lidar = {};
  std::vector<std::string> camera_names;  ///< all that the drive has
  std::vector<RecordedTopic> topics;      ///< of a bag

  std::vector<Frame> frames;             ///< in order of time
  std::vector<ScanHeader> scan_headers;  ///< in order of time
  Sensor sensor = Sensor::lidar;
  /// Depth images whose pixels are those of the images by definition: nothing turns the camera against the sensor.
  bool registered_depth = false;
  std::optional<DepthImages> depth_images;  ///< where scans are made of such: ScanHeader::file is one
  Trajectory poses;                         ///< world_from_lidar as given; empty where none are
  std::vector<GeoFix> fixes;                ///< of a GPS receiver, its antenna in the LiDAR's axes; empty where there is none
  /// Factor of the given positions to meters of the drive's own place: the Mercator scale of oxts; 1 where poses are
  /// metric. Two drives share a world when their positions are brought to one scale.
  double world_scale = 1;
  /// The camera itself is what given poses are of: text files of poses are in its axes, not in those of a LiDAR.
  bool camera_is_posed = false;

  Lazy<cv::Mat3b> images;  ///< as `frames`; BGR
  Lazy<Scan> scans;        ///< as `scan_headers`
  Lazy<GivenMap> map;      ///< one, where the drive brings a static map instead of scans; else empty
  Lazy<cv::Mat1b> masks;   ///< as `frames`, 255 = remove; empty where the drive brings none

  /// The file of `map`; empty where there is none.
  std::filesystem::path map_file;
  /// Files that everything depends on besides images, scans and masks (calibration, poses, labels).
  std::vector<std::filesystem::path> other_files;
  /// Mask files as `frames` (an empty path: none for that frame); empty where the drive brings none.
  std::vector<std::filesystem::path> mask_files;
  /// Gaps that the rest can bridge, in words that name them.
  std::vector<std::string> warnings;

  /// Whether anything tells how far away what the images show is.
  bool has_geometry() const { return !scan_headers.empty() || !map.empty(); }
  bool has_labels() const {
    for (const Frame& frame : frames)
      if (!frame.labels.empty()) return true;
    return labeled;
  }
  FrameLabels labels() const {
    FrameLabels out;
    for (const Frame& frame : frames) out.push_back(frame.labels);
    return out;
  }
  /// Meters below and beyond which returns are left out, unless the user says otherwise. A LiDAR on a car measures the car
  /// itself; a depth camera sees nothing of its bearer, and measures no nearer. The noise of a depth camera grows with the
  /// square of the depth, to decimeters at 10 m.
  double least_range_m() const { return sensor == Sensor::depth_camera ? 0.1 : 2; }
  double most_range_m() const { return sensor == Sensor::depth_camera ? 10 : 120; }
  bool labeled = false;         ///< the drive came with labels, be they empty
  bool labeled_around = false;  ///< they hold for all cameras: 3D boxes of what stands all round
};

/// A range of frames by the drive's own numbers, both included.
struct FrameRange {
  int first = 0, last = 0;

  bool contains(int number) const { return number >= first && number <= last; }
};

/// Nanoseconds, both included.
struct TimeSpan {
  std::int64_t first = 0, last = 0;
};

}  // namespace dvi
