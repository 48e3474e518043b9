#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// The endings of files that are read as videos: .mp4, .mkv, .mov, .avi.
extern const std::vector<std::string> kVideoEndings;

/// Returns whether a file is a video, by its ending in upper or lower case.
bool is_video(const fs::path& file);

/// Decodes the frames of a video file on demand. The bytes of a frame do not depend on the order or the thread of the calls. A
/// video's rotation is not applied, like that of images.
class VideoReader {
 public:
  /// Reads the times of all frames without decoding them. Throws InputError if the file is not a video, is truncated, or has no
  /// times.
  explicit VideoReader(fs::path file);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  cv::Size size() const;  ///< as stored
  /// Returns the angle in degrees clockwise, 0 to 359, by which players rotate the frames.
  int rotation_deg() const;
  /// Returns the presentation times in nanoseconds, relative to the first frame.
  const std::vector<std::int64_t>& times_ns() const;
  /// Decodes frame i of times_ns(). Throws InputError if it is damaged.
  cv::Mat3b operator[](std::size_t i) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dvi::media
