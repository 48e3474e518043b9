#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/frame_name.h"
#include "dvi/exports/labeled_scans.h"
#include "dvi/exports/recorded_input.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/earth_place.h"
#include "dvi/geometry/se3.h"
#include "dvi/media/image_edit.h"

namespace dvi::exports {

/// A cleaned camera of a result.
struct ResultCamera {
  std::string name;
  Camera camera;
};

/// A frame of a finished result.
struct ResultFrame {
  std::string name;        ///< as core/frame_name.h: its images are NAME.png, or NAME.png of CAMERA if there are several
  std::size_t camera = 0;  ///< index in Result::cameras()
  fs::path input;          ///< the input image
  std::int64_t time_ns = 0;
  SE3 world_from_camera;
};

/// Functions of other modules that read the drive of a result again. It must still exist.
struct ResultSources {
  LabelScans label_scans = {};  ///< commands::label_scans
  FindInput find_input = {};    ///< commands::find_recorded_input
};

/// An output folder of `dvi run` as other tools need it: the cleaned cameras and their frames with refined poses. Images are
/// read on demand. The world is the target's first LiDAR pose: x forward, y left, z up.
class Result {
 public:
  /// Reads the tables of OUT. Throws InputError if OUT is not a finished result, is damaged, or has no poses (methods without a
  /// map).
  explicit Result(const fs::path& out, ResultSources from = {});

  const fs::path& folder() const { return folder_; }
  const std::vector<ResultCamera>& cameras() const { return cameras_; }
  const Camera& camera(std::size_t frame) const { return cameras_[frames_[frame].camera].camera; }
  cv::Size size(std::size_t frame) const { return {camera(frame).width, camera(frame).height}; }
  /// Returns the frames of each camera in order of time, one camera after the other.
  const std::vector<ResultFrame>& frames() const { return frames_; }
  /// Returns the number of frames of a camera.
  std::size_t count_frames(std::size_t camera) const;
  const std::optional<EarthPlace>& place() const { return place_; }  ///< of the world by GPS; none if unknown

  fs::path picture(const std::string& kind, std::size_t frame) const {
    return folder_ / picture_file(kind, frames_[frame].name);
  }
  cv::Mat3b image(std::size_t frame) const;
  cv::Mat1b kind(std::size_t frame) const;        ///< harmonize::Kind
  cv::Mat1b confidence(std::size_t frame) const;  ///< 255 = 1, for filled pixels
  cv::Mat1f depth(std::size_t frame) const;       ///< Camera::depth() in meters; 0: unknown or sky
  /// Returns a mask: 255 for original and copied pixels, 0 for pixels without observation.
  cv::Mat1b evidence(std::size_t frame) const;
  /// Returns the pixels that the run filled, to be written into the recorded image.
  media::ImageEdit edit(std::size_t frame) const;
  /// Labels the scans of the drive.
  LabeledScans label_scans(Progress& progress) const { return from_.label_scans(folder_, progress); }
  RecordedInput input() const { return from_.find_input(folder_); }

 private:
  void read_sources(std::size_t cameras);
  void read_poses(const fs::path& folder, std::size_t camera);
  void read_place();

  fs::path folder_;
  ResultSources from_;
  std::vector<ResultCamera> cameras_;
  std::vector<ResultFrame> frames_;
  std::optional<EarthPlace> place_;
};

}  // namespace dvi::exports
