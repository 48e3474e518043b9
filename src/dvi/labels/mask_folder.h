#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::labels {

/// Sets drive.mask_files to the PNG masks of folders, tied to frames by NAME (NAME.png, or NAME.jpg.png as for
/// COLMAP; else as match_names() says): an empty path where a frame has none, an empty list where there are no masks. Warns of
/// masks that belong to no frame, except those of images that are missing between the first and the last, and of masks that lie
/// in the folder above or in one below. InputError where no mask belongs to a frame.
void match_masks(Drive& drive, const std::vector<fs::path>& folders);

/// Where the masks of a camera lie in a folder that holds those of several, as `dvi mask` writes it.
fs::path camera_masks(const fs::path& folder, const std::string& camera);

/// Finds the folder of a camera's masks in a folder of several cameras': masks/CAMERA or CAMERA.
std::optional<fs::path> folder_of_camera(const fs::path& given, const std::string& camera);

/// Gives an open drive the masks of a folder, or of its masks/CAMERA or CAMERA, instead of its own. The drive may have been
/// cut: masks of its other images are left alone. Warns of masks of no image. InputError where none belongs to a frame.
void attach_masks(Drive& drive, const fs::path& given);

/// Sets drive.masks to the drive.mask_files: 255 where they are not 0, and nothing where a frame has none.
void attach_mask_files(Drive& drive);

/// Names the frames without a mask file, which keep their traffic; none where all have one.
std::optional<std::string> frames_without_mask(const Drive& drive);

/// The names of all images beside those of the drive's frames, also of those that --frames left out.
std::set<std::string> recorded_names(const Drive& drive);

}  // namespace dvi::labels
