#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// Of the files that are taken for videos: .mp4, .mkv, .mov, .avi.
extern const std::vector<std::string> kVideoEndings;

/// Whether a file is a video, by its ending in either case.
bool is_video(const fs::path& file);

/// The frames of a video file, decoded on demand: the same bytes in whatever order and from whichever thread they are asked
/// for. A video's rotation is not applied, as that of an image is not.
class VideoReader {
 public:
  /// Reads the times of all frames, and decodes none. InputError where the file is no video, was cut, or tells no times.
  explicit VideoReader(fs::path file);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  cv::Size size() const;  ///< as stored
  /// Degrees clockwise, 0 to 359, by which players turn the frames.
  int rotation_deg() const;
  /// As shown, counted from the first frame.
  const std::vector<std::int64_t>& times_ns() const;
  /// Frame i of times_ns(). InputError where it is damaged.
  cv::Mat3b operator[](std::size_t i) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dvi::media
