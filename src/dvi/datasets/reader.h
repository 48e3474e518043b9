#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/gap.h"

namespace dvi::datasets {

struct ReadOptions {
  std::string camera = {};                ///< empty: the drive's first
  std::optional<FrameRange> frames = {};  ///< cut the drive to these (frames, and the scans near them in time)
  std::optional<TimeSpan> span = {};      ///< instead of `frames`
  std::vector<std::string> topics = {};   ///< of a bag, which to take: "image=/front/image_raw"
};

/// What a reader finds from file names and text files, for the whole drive. read_drive cuts it to --frames, reports the
/// remaining gaps, and attaches the lazy images, masks and scans.
struct DriveContents {
  Drive drive;
  std::vector<Gap> gaps;
  std::function<Scan(const ScanHeader&)> read_scan;
  std::size_t point_bytes = 16;  ///< of .bin scans
  /// Called with the recording once it is cut to the frames asked for: sets `read_scan` and `point_bytes` by samples of the
  /// scans that are left. None: they are set already.
  std::function<void(DriveContents&)> inspect_scans = {};
  std::function<cv::Mat3b(const Frame&)> read_image = {};  ///< none: Frame::file is the image's
  int value_bits = 16;                                     ///< that 16-bit images use, as find_value_bits() determines them
};

/// Whether the numbers from the first frame to the last, in steps, can be listed one by one; where a stray file name makes them
/// more than ten times the frames, warns of it instead.
bool can_list_numbers(Drive& drive, int step);

/// One layout of recordings that dvi can read.
struct DriveFormat {
  std::string name;     ///< as `dvi formats` lists it
  std::string summary;  ///< one line: how it is recognized
  std::function<bool(const std::filesystem::path&)> recognize;
  std::function<DriveContents(const std::filesystem::path&, const ReadOptions&)> read;
  /// Files and folders that such a drive has, with which an unknown folder is compared; "a|b": one of them.
  std::vector<std::string> parts = {};
};

DriveFormat folder_format();
DriveFormat colmap_format();
DriveFormat kitti_raw_format();
DriveFormat kitti_360_format();
DriveFormat kitti_odometry_format();
DriveFormat nuscenes_format();
DriveFormat rosbag_format();
DriveFormat apolloscape_format();
DriveFormat seven_scenes_format();
DriveFormat tum_rgbd_format();
DriveFormat scannet_format();

/// Whether a file holds the images of many frames: a bag or a video.
bool holds_many_images(const std::filesystem::path& file);

/// All formats; a new reader is one file and one line here.
const std::vector<DriveFormat>& drive_formats();

/// Opens a drive of whatever format: looks at names and parses text, reads no image, and of scans some samples. InputError
/// where the folder is none, lacks what it needs, or does not have the frames asked for.
Drive read_drive(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dvi::datasets
