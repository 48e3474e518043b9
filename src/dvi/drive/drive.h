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
#include "dvi/drive/point_labels.h"
#include "dvi/drive/scan.h"
#include "dvi/drive/sensor.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/earth_place.h"
#include "dvi/geometry/trajectory.h"

namespace dvi {

/// One image of the drive's selected camera.
struct Frame {
  int number = 0;    ///< the number in the drive, as used by --frames
  std::string name;  ///< the file name of the image without its ending
  std::int64_t time_ns = 0;
  std::filesystem::path file;
  std::vector<Label> labels;
};

/// The name and times of a scan, which is one revolution of the LiDAR; its points are read later. Its stamp is its middle.
struct ScanHeader {
  std::string name;
  std::int64_t time_ns = 0, start_ns = 0, end_ns = 0;
  std::filesystem::path file;
};

/// The camera of depth images and their unit.
struct DepthImages {
  Camera camera;
  std::optional<SE3> depth_from_color;  ///< none: the depth is registered to the images
  double units_per_meter = 1000;
};

/// One topic of a bag.
struct RecordedTopic {
  std::string name, type;
  std::size_t messages = 0;
  double rate_hz = 0;
  std::string use;  ///< its use, such as "images of front"; empty: it is not used
};

/// A recording as found by a reader. Images, scans and masks are read on demand and cached within bounds.
struct Drive {
  std::filesystem::path path;
  std::string format;
  std::string camera_name;
  Camera camera;
  SE3 camera_from_lidar;
  /// The camera in whose axes KITTI's label files give their boxes; none: the drive's camera.
  std::optional<SE3> box_camera_from_lidar = {};
  std::vector<std::string> camera_names;  ///< all cameras of the drive
  std::vector<RecordedTopic> topics;      ///< the topics of a bag

  std::vector<Frame> frames;             ///< in order of time
  std::vector<ScanHeader> scan_headers;  ///< in order of time
  Sensor sensor = Sensor::lidar;
  /// Whether the pixels of depth images are those of the images by definition, so that the extrinsics are exact.
  bool registered_depth = false;
  std::optional<DepthImages> depth_images;  ///< if the scans are made of depth images, which ScanHeader::file refers to
  Trajectory poses;                         ///< given world_from_lidar; empty if there are none
  std::vector<GeoFix> fixes;  ///< of a GPS receiver, with its antenna in the LiDAR's axes; empty if there are none
  /// The factor from the given positions to meters: the Mercator scale of oxts, or 1 for metric poses. Two drives share a world
  /// if their positions have the same scale.
  double world_scale = 1;
  /// Whether given poses are those of the camera itself, so that text files of poses are in its axes instead of those of a
  /// LiDAR.
  bool camera_is_posed = false;

  Lazy<cv::Mat3b> images;  ///< one per frame; BGR
  Lazy<Scan> scans;        ///< one per scan header
  Lazy<GivenMap> map;      ///< one item if the drive has a static map instead of scans; otherwise empty
  Lazy<cv::Mat1b> masks;   ///< one per frame, 255 = remove; empty if the drive has none
  /// One per scan header: the labels of its returns on removed objects; empty if the drive has none.
  Lazy<PointLabels> point_labels = {};

  /// The file of `map`; empty if there is none.
  std::filesystem::path map_file;
  /// Files other than images, scans and masks that determine the drive (calibration, poses, labels).
  std::vector<std::filesystem::path> other_files;
  /// One mask file per frame, an empty path for a frame without one; empty if the drive has none.
  std::vector<std::filesystem::path> mask_files;
  /// The video whose frames are the masks; empty if there is none.
  std::filesystem::path mask_video;
  /// Warnings about gaps that do not prevent a run.
  std::vector<std::string> warnings;

  /// Returns whether scans or a map determine the distances of the surfaces in the images.
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
  /// Return the default range in meters outside of which returns are ignored. A LiDAR on a car measures the car itself. A depth
  /// camera does not observe its carrier, and its noise grows with the square of the depth, to decimeters at 10 m.
  double min_range_m() const { return sensor == Sensor::depth_camera ? 0.1 : 2; }
  double max_range_m() const { return sensor == Sensor::depth_camera ? 10 : 120; }
  bool labeled = false;         ///< the drive has labels, which may be empty
  bool labeled_around = false;  ///< the labels are 3D boxes all around the vehicle, for all cameras
};

/// A range of frames by their numbers in the drive, both ends included.
struct FrameRange {
  int first = 0, last = 0;

  bool contains(int number) const { return number >= first && number <= last; }
};

/// A span of time in nanoseconds, both ends included.
struct TimeSpan {
  std::int64_t first = 0, last = 0;
};

}  // namespace dvi
