#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::labels {

/// The endings of mask files: PNG images and arrays of NumPy.
inline const std::vector<std::string> kMaskEndings = {".png", ".npy"};

/// Sets drive.mask_files to the masks of folders, matched to frames by NAME (NAME.png, or NAME.jpg.png as for COLMAP;
/// otherwise by match_names()). A frame without a mask has an empty path; the list is empty if there are no masks. Adds
/// warnings about masks without a frame, except those of missing images between the first and the last frame, and about masks
/// in the folder above or in one below. Throws InputError if no mask belongs to a frame.
void match_masks(Drive& drive, const std::vector<fs::path>& folders);

/// Returns the folder of a camera's masks within a folder for several cameras, as written by `dvi mask`.
fs::path camera_masks(const fs::path& folder, const std::string& camera);

/// Finds the folder of a camera's masks within a folder for several cameras: masks/CAMERA or CAMERA.
std::optional<fs::path> find_camera_folder(const fs::path& given, const std::string& camera);

/// Replaces the masks of an open drive by those of a folder, or of its masks/CAMERA or CAMERA. Accepts masks of images
/// outside the selected frames. Adds a warning about masks without an image. Throws InputError if no mask belongs to a frame.
/// `given` may be a video of masks; see attach_mask_video().
void attach_masks(Drive& drive, const fs::path& given);

/// Sets drive.masks to the drive.mask_files: 255 where they are not 0; no mask for a frame without a file.
void attach_mask_files(Drive& drive);

/// Describes the frames without a mask file, in which nothing is removed. Returns nothing if all frames have one.
std::optional<std::string> describe_frames_without_mask(const Drive& drive);

/// Lists the names of all images in the folders of the drive's frames, including those outside --frames.
std::set<std::string> list_recorded_names(const Drive& drive);

}  // namespace dvi::labels
