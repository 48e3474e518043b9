#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::result {

// The places of files in the output folder of a run. `cameras` are those of list_cameras() (core/frame_name.h).

/// Returns the folders of the pictures of a frame: "frames" for frames/NAME.png, and so on.
const std::vector<std::string>& picture_folders();

/// Throws InputError if a camera of a result with several cameras cannot have a folder of its name beside the other folders.
void require_camera_names(const fs::path& out, const std::vector<std::string>& cameras);

/// Lists the pictures of a frame, relative to the result.
std::vector<std::string> list_pictures(const std::string& frame);

/// Lists the folders that a run writes to.
std::vector<fs::path> list_own_folders(const fs::path& out, const std::vector<std::string>& cameras);

/// Lists the names of the frames that a run began to write, in natural order.
std::vector<std::string> list_begun_frames(const fs::path& out);

/// Lists the existing files besides the frames, relative to the result; a baseline has no map. Reports and options are left
/// out, because they contain times and paths, and because the report is written again when a result is scored.
std::vector<std::string> list_other_files(const fs::path& out, const std::vector<std::string>& cameras);

/// Return the manifests of a finished frame, and of the files other than the frames.
fs::path frame_manifest(const fs::path& out, const std::string& name);
fs::path result_manifest(const fs::path& out);

/// Returns the place of an image of the run that an import replaced; both are relative to the result (frames/NAME.png).
std::string file_before_import(const std::string& picture);

}  // namespace dvi::result
