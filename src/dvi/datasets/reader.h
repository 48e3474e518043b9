#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/gap.h"

namespace dvi::datasets {

/// The parts of a drive to read.
struct ReadOptions {
  std::string camera = {};                ///< empty: the drive's usual camera
  std::optional<FrameRange> frames = {};  ///< reads only these frames, and the scans near them in time
  std::optional<TimeSpan> span = {};      ///< reads only this time span; used instead of `frames`
  std::vector<std::string> topics = {};   ///< selected topics of a bag: "image=/front/image_raw"
};

/// The result of a format's reader, which looks at file names and text files of the whole drive. read_drive() cuts it to
/// --frames, reports the remaining gaps, and attaches the lazy images, masks and scans.
struct DriveContents {
  Drive drive;
  std::vector<Gap> gaps;
  std::function<Scan(const ScanHeader&)> read_scan;
  std::size_t point_bytes = 16;  ///< of scans in .bin files
  /// Sets `read_scan` and `point_bytes` by samples of the scans. It is called after the recording is limited to the requested
  /// frames. None: both are set already.
  std::function<void(DriveContents&)> inspect_scans = {};
  std::function<cv::Mat3b(const Frame&)> read_image = {};  ///< none: Frame::file is the image
  int value_bits = 16;                                     ///< used bits of 16-bit images, see find_value_bits()
};

/// Returns whether all numbers from the first frame to the last one, in steps, can be listed. If a stray file name makes them
/// more than ten times the number of frames, adds a warning and returns false.
bool can_list_numbers(Drive& drive, int step);

/// One layout of recordings that dvi can read.
struct DriveFormat {
  std::string name;     ///< shown by `dvi formats`
  std::string summary;  ///< one line: the files by which it is recognized
  std::function<bool(const std::filesystem::path&)> recognize;
  std::function<DriveContents(const std::filesystem::path&, const ReadOptions&)> read;
  /// The files and folders of such a drive, with which an unknown folder is compared; "a|b" means one of them.
  std::vector<std::string> parts = {};
  /// The number of folders from the drive up to the root of the data set, which holds all files of the drive.
  int levels_to_root = 0;
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

/// Returns whether a file holds the images of many frames: a bag or a video.
bool holds_many_images(const std::filesystem::path& file);

/// Returns all formats. A new reader is one file, its declaration above, and one line here.
const std::vector<DriveFormat>& drive_formats();

/// Returns the root of the data set of a drive: the folder that holds its calibration, scans, and images, such as the parent of
/// the date for KITTI. It is the drive's own folder for most formats.
std::filesystem::path find_data_root(const Drive& drive);

/// Opens a drive of any format. Looks at names and parses text files; reads no images, and only samples of the scans. Throws
/// InputError if the path is not a drive, if required files are missing, or if the requested frames do not exist.
Drive read_drive(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dvi::datasets
