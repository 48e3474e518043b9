#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/core/options.h"

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

/// A video to be written. Odd sizes get a repeated last column or row, because players require even sizes.
struct VideoTarget {
  fs::path path;
  cv::Size size;  ///< of the frames
  VideoOptions options = {};
};

/// An encoded frame of a video.
struct EncodedFrame {
  bool is_key = false;  ///< whether it can be decoded without any others
  std::vector<std::uint8_t> bytes;

  bool operator==(const EncodedFrame&) const = default;
};

/// Consecutive encoded frames of a video. The first is a key frame, so that they can be decoded without any others.
using VideoSegment = std::vector<EncodedFrame>;

/// Encodes the frames of one segment. Segments are independent of each other, so that several threads can encode those of a
/// video.
class SegmentEncoder {
 public:
  explicit SegmentEncoder(const VideoTarget& target);
  ~SegmentEncoder();
  SegmentEncoder(const SegmentEncoder&) = delete;
  SegmentEncoder& operator=(const SegmentEncoder&) = delete;

  /// Adds a frame of the size of the video.
  void push(const cv::Mat3b& frame);
  /// Adds images stacked vertically, each extended to an even number of rows; together they have the size of the video.
  void push_stacked(const std::vector<cv::Mat3b>& images);
  /// Returns all frames that were added. To be called once, at the end.
  VideoSegment finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes an mp4 (yuv420p, BT.709, playable while it loads) segment by segment, without keeping frames. Equal frames in equal
/// segments give equal bytes. Throws InputError on a full or read-only disk. Leaves no file behind if it is destroyed without
/// finish().
class VideoWriter {
 public:
  explicit VideoWriter(const VideoTarget& target);
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Adds the frames of a segment.
  void append(const VideoSegment& segment);
  /// Completes the video and moves it to its path.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Memory of an encoder in bytes per pixel of its video.
inline constexpr std::size_t kEncoderBytesPerPixel = 40;

/// Frames [first, last) of a video.
struct FrameSpan {
  std::size_t first = 0, last = 0;
};

/// Divides a video into segments that are short, so that players seek fast, and several threads have work.
std::vector<FrameSpan> divide_into_segments(std::size_t frames);

}  // namespace dvi::media
