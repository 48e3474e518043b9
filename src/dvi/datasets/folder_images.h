#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/datasets/drive_config.h"
#include "dvi/media/video_reader.h"

namespace dvi::datasets {

/// A file and the NAME of its frame or scan.
struct NamedFile {
  std::string name;
  fs::path file;
};

/// Throws InputError if two files have one NAME.
std::vector<NamedFile> name_files(const std::vector<fs::path>& files);

/// The images of a camera of the `folder` layout: images/CAMERA/NAME.png, or the frames of images/CAMERA.mp4.
struct FolderImages {
  std::vector<NamedFile> files;
  std::shared_ptr<const media::VideoReader> video;  ///< whose frames the images are; none: the images are files
};

/// Finds the images of a camera. Throws InputError if it has files and a video.
FolderImages find_images(const fs::path& drive, const std::string& camera);

bool has_images(const fs::path& drive, const std::string& camera);

/// Names the cameras that have images, but no table in dvi.toml.
std::optional<std::string> describe_uncalibrated_cameras(const fs::path& drive, const DriveConfig& config);

}  // namespace dvi::datasets
