#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi {

// The frames of a result have the names of their images, such as 000012. If the result has several cameras, the name of the
// camera comes first: front/000012.

/// Returns the name of a frame in a result; `camera` is empty if the result has one camera.
std::string join_frame_name(const std::string& camera, const std::string& image);

/// Returns the camera in the name of a frame; empty if the result has one camera.
std::string camera_of_frame(const std::string& frame);

/// Returns the name of the frame's image without its camera.
std::string image_of_frame(const std::string& frame);

/// Returns the file of one of a frame's pictures, relative to the result: frames/000012.png or front/frames/000012.png.
std::string picture_file(const std::string& folder, const std::string& frame);

/// Lists the cameras in the names of frames, each once; one empty name if the result has one camera.
std::vector<std::string> list_cameras(const std::vector<std::string>& frames);

/// The images of frames in a folder: NAME.png, or CAMERA/NAME.png if the result has several cameras. If one of them has no
/// folder, its images are those beside the folders of the others, as `dvi synth` writes the truth of the first camera.
class FrameImages {
 public:
  FrameImages(fs::path folder, const std::vector<std::string>& frames);

  fs::path file(const std::string& frame) const;
  /// Lists the frames whose images the folder has; they may be others than those of the result.
  std::vector<std::string> list() const;

 private:
  fs::path folder_;
  std::string camera_beside_;  ///< the one without a folder; empty: none
};

/// Lists the frames NAME.png of a result (OUT/frames/, or OUT/CAMERA/frames/ of every camera) in natural order.
std::vector<std::string> list_frames(const fs::path& out);

}  // namespace dvi
