#pragma once

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
    table.add("encoder", encoder, {"auto", "h264", "mpeg4"}, "Encoder of the videos; auto uses h264 where available.");
  }
};

/// An mp4 (yuv420p, BT.709, playable while it loads) that takes frame after frame and keeps none. The same frames give the
/// same bytes. Odd sizes gain a repeated last column or row, for players want even ones. InputError on a full or read-only
/// disk. Destroyed without finish(), it leaves nothing behind.
class VideoWriter {
 public:
  VideoWriter(const fs::path& path, cv::Size size, const VideoOptions& options = {});
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  void push(const cv::Mat3b& frame);  ///< of the size given at the start
  /// Images one below the other, each of an even number of rows or extended to one; together of the size given at the start.
  void push_stacked(const std::vector<cv::Mat3b>& images);
  void finish();  ///< the video is at its path afterward, not before

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dvi::media
