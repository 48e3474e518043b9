#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/options.h"
#include "dvi/core/threads.h"

namespace dvi::media {

struct VideoOptions {
  double fps = 10;
  int crf = 18;
  std::string encoder = "auto";

  void describe(OptionTable& table) {
    table.section("video");
    table.add("fps", fps, {0.1, 240}, "Frames per second of the videos.");
    table.add("crf", crf, {0, 51}, "Quality of the videos: 0 is lossless, 18 visually lossless, 28 small.");
    table.add("encoder", encoder, {"auto", "h264", "mpeg4"}, "Encoder of the videos; auto uses h264 if available.");
  }
};

/// Consecutive encoded frames of a video, which can be decoded without any others.
class VideoSegment {
 public:
  VideoSegment(VideoSegment&&) noexcept;
  VideoSegment& operator=(VideoSegment&&) noexcept;
  ~VideoSegment();

 private:
  friend class SegmentEncoder;
  friend class VideoWriter;
  struct Impl;
  explicit VideoSegment(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Encodes the frames of one segment. Segments are independent of each other, so that several threads can encode those of a
/// video.
class SegmentEncoder {
 public:
  SegmentEncoder(SegmentEncoder&&) noexcept;
  ~SegmentEncoder();

  /// Adds a frame of the size of the video.
  void push(const cv::Mat3b& frame);
  /// Adds images stacked vertically, each extended to an even number of rows; together they have the size of the video.
  void push_stacked(const std::vector<cv::Mat3b>& images);
  /// Returns all frames that were added. To be called once, at the end.
  VideoSegment finish();

 private:
  friend class VideoWriter;
  struct Impl;
  explicit SegmentEncoder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Writes an mp4 (yuv420p, BT.709, playable while it loads) segment by segment, without keeping frames. Equal frames in equal
/// segments give equal bytes. Odd sizes get a repeated last column or row, because players require even sizes. Throws
/// InputError on a full or read-only disk. Leaves no file behind if it is destroyed without finish().
class VideoWriter {
 public:
  VideoWriter(const fs::path& path, cv::Size size, const VideoOptions& options = {});
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Begins a segment. May be called from any thread.
  SegmentEncoder new_segment() const;
  /// Adds the frames of a segment.
  void append(VideoSegment segment);
  /// Completes the video and moves it to its path.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Memory of an encoder in bytes per pixel of its video.
inline constexpr std::size_t kEncoderBytesPerPixel = 40;

/// Encodes a video of `frames` frames in segments on all threads: calls encode(first, last) for the frames [first, last) of
/// each segment, and append(result of encode) in order. As many segments are in progress as fit into WorkMemory::of_process(),
/// at least one, if each takes `bytes`. Segments are short, so that players seek fast, and several threads have work.
template <class Encode, class Append>
void encode_segments(std::size_t frames, const Encode& encode, const Append& append, std::size_t bytes) {
  constexpr std::size_t kSegmentFrames = 16;
  make_and_use((frames + kSegmentFrames - 1) / kSegmentFrames,
               [&](std::size_t segment) {
                 const std::size_t first = segment * kSegmentFrames;
                 return encode(first, std::min(first + kSegmentFrames, frames));
               },
               [&](std::size_t, auto encoded) { append(std::move(encoded)); }, bytes);
}

}  // namespace dvi::media
