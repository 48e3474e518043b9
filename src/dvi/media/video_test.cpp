#include "dvi/media/video.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavcodec/codec.h>
#include <libavcodec/packet.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
#include <libavutil/rational.h>
}

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::media {
namespace {

struct Decoded {
  cv::Size size;
  double fps = 0;
  std::vector<cv::Mat1b> luma;
};

/// Decodes the Y plane of all frames by libav.
Decoded decode(const fs::path& path) {
  Decoded out;
  AVFormatContext* format = nullptr;
  if (avformat_open_input(&format, path.c_str(), nullptr, nullptr) < 0) return out;
  avformat_find_stream_info(format, nullptr);
  const AVStream* stream = format->streams[0];
  out.fps = av_q2d(stream->avg_frame_rate);
  AVCodecContext* codec = avcodec_alloc_context3(avcodec_find_decoder(stream->codecpar->codec_id));
  avcodec_parameters_to_context(codec, stream->codecpar);
  avcodec_open2(codec, nullptr, nullptr);
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  const auto take = [&] {
    while (avcodec_receive_frame(codec, frame) == 0) {
      const cv::Mat1b luma(frame->height, frame->width, frame->data[0], static_cast<std::size_t>(frame->linesize[0]));
      out.luma.push_back(luma.clone());
    }
  };
  while (av_read_frame(format, packet) == 0) {
    avcodec_send_packet(codec, packet);
    av_packet_unref(packet);
    take();
  }
  avcodec_send_packet(codec, nullptr);
  take();
  out.size = {codec->width, codec->height};
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&codec);
  avformat_close_input(&format);
  return out;
}

cv::Mat3b picture(cv::Size size, int i) {
  cv::Mat3b image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto v = static_cast<uchar>(128 + 60 * std::sin(0.1 * (x + 2 * i)) * std::cos(0.07 * y));
      image(y, x) = {v, v, v};
    }
  return image;
}

/// Writes a video of one segment.
void write_segment(const VideoTarget& target, const std::function<void(SegmentEncoder&)>& push_frames) {
  VideoWriter video(target);
  SegmentEncoder segment(target);
  push_frames(segment);
  video.append(segment.finish());
  video.finish();
}

class Video : public testing::Test {
 protected:
  fs::path write(const std::string& name, cv::Size size, int frames, const VideoOptions& options = {}) const {
    write_segment({folder / name, size, options}, [&](SegmentEncoder& segment) {
      for (int i = 0; i < frames; ++i) segment.push(picture(size, i));
    });
    return folder / name;
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
  const TempFolder temporary;
  const fs::path folder = temporary.path;
};

TEST_F(Video, DecodesToThePushedFrames) {
  const cv::Size size(96, 64);
  VideoOptions options;
  options.fps = 12.5;
  const Decoded video = decode(write("a.mp4", size, 30, options));
  EXPECT_EQ(video.size, size);
  EXPECT_DOUBLE_EQ(video.fps, 12.5);
  ASSERT_EQ(video.luma.size(), 30U);
  for (int i = 0; i < 30; ++i) {
    cv::Mat1b gray, expected;
    cv::extractChannel(picture(size, i), gray, 0);
    gray.convertTo(expected, CV_8U, 219.0 / 255.0, 16);
    EXPECT_LT(cv::norm(video.luma[static_cast<std::size_t>(i)], expected, cv::NORM_L1) / size.area(), 2.0) << i;
  }
}

// Frames of segments of all lengths follow each other, and each segment can be decoded on its own.
TEST_F(Video, ConsistsOfSegmentsOfAnyLength) {
  const cv::Size size(96, 64);
  for (const char* encoder : {"auto", "mpeg4"}) {
    const VideoTarget target{folder / "a.mp4", size, {.encoder = encoder}};
    VideoWriter video(target);
    const std::vector<int> lengths{7, 1, 2, 3, 40, 1};
    std::vector<VideoSegment> segments;
    int first = 0;
    for (const int length : lengths) {
      SegmentEncoder segment(target);
      for (int i = first; i < first + length; ++i) segment.push(picture(size, i));
      segments.push_back(segment.finish());
      first += length;
    }
    for (const VideoSegment& segment : segments) video.append(segment);
    video.finish();
    const Decoded decoded = decode(folder / "a.mp4");
    ASSERT_EQ(decoded.luma.size(), static_cast<std::size_t>(first)) << encoder;
    for (int i = 0; i < first; ++i) {
      cv::Mat1b gray, expected;
      cv::extractChannel(picture(size, i), gray, 0);
      gray.convertTo(expected, CV_8U, 219.0 / 255.0, 16);
      EXPECT_LT(cv::norm(decoded.luma[static_cast<std::size_t>(i)], expected, cv::NORM_L1) / size.area(), 2.0) << encoder << i;
    }
  }
}

TEST_F(Video, HasEqualBytesForEqualFrames) {
  EXPECT_EQ(read_file(write("a.mp4", {96, 64}, 20)), read_file(write("b.mp4", {96, 64}, 20)));
}

// For odd sizes, chroma needs pixels beyond the last column and row, where the memory is not part of the image.
TEST_F(Video, DependsOnThePixelsOnly) {
  const cv::Size size(97, 65);
  const std::array<std::string, 4> names{"a.mp4", "b.mp4", "c.mp4", "d.mp4"};
  parallel_for(names.size(), [&](std::size_t k) {
    const auto around = static_cast<uchar>(80 * k);
    write_segment({folder / names[k], {size.width, 132}}, [&](SegmentEncoder& segment) {
      for (int i = 0; i < 20; ++i) {
        cv::Mat3b large(size.height + 2, size.width + 32, cv::Vec3b::all(around));
        const cv::Mat3b image = large(cv::Rect({0, 0}, size));
        picture(size, i).copyTo(image);
        segment.push_stacked({image, image});
      }
    });
  });
  for (const std::string& name : names) EXPECT_EQ(read_file(folder / name), read_file(folder / names[0])) << name;
}

TEST_F(Video, CanBePlayedWhileItLoads) {
  const std::string bytes = read_file(write("a.mp4", {96, 64}, 5));
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

TEST_F(Video, RepeatsTheLastColumnAndRowOfOddSizes) {
  const Decoded video = decode(write("a.mp4", {97, 65}, 3));
  ASSERT_EQ(video.size, cv::Size(98, 66));
  ASSERT_EQ(video.luma.size(), 3U);
  const cv::Mat1b& luma = video.luma[0];
  EXPECT_LT(cv::norm(luma.col(96), luma.col(97), cv::NORM_INF), 12);
  EXPECT_LT(cv::norm(luma.row(64), luma.row(65), cv::NORM_INF), 12);
}

// BT.709 in video range has white 235, black 16, and pure red, green and blue by the weights of the standard.
TEST_F(Video, HasTheColorsOfTheStandard) {
  const cv::Size size(64, 64);
  const std::vector<std::pair<cv::Vec3b, int>> cases{
      {{255, 255, 255}, 235}, {{0, 0, 0}, 16}, {{0, 0, 255}, 63}, {{0, 255, 0}, 173}, {{255, 0, 0}, 32}};
  write_segment({folder / "a.mp4", size, {.crf = 1}}, [&](SegmentEncoder& segment) {
    for (const auto& [color, luma] : cases) segment.push(cv::Mat3b(size, color));
  });
  const Decoded decoded = decode(folder / "a.mp4");
  ASSERT_EQ(decoded.luma.size(), cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) EXPECT_NEAR(decoded.luma[i](32, 32), cases[i].second, 1) << i;
}

TEST_F(Video, BeginsStackedImagesOnEvenRows) {
  const cv::Size size(97, 65);
  write_segment({folder / "a.mp4", {97, 132}}, [&](SegmentEncoder& segment) {
    segment.push_stacked({cv::Mat3b(size, cv::Vec3b::all(0)), cv::Mat3b(size, cv::Vec3b::all(255))});
    EXPECT_THROW(segment.push_stacked({cv::Mat3b(size)}), std::logic_error);
  });
  const Decoded decoded = decode(folder / "a.mp4");
  ASSERT_EQ(decoded.size, cv::Size(98, 132));
  EXPECT_NEAR(decoded.luma.at(0)(64, 50), 16, 8);
  EXPECT_NEAR(decoded.luma.at(0)(67, 50), 235, 8);
}

TEST_F(Video, IsLargerWithLowerCrfAndSupportsMpeg4) {
  VideoOptions fine, coarse, mpeg4;
  fine.crf = 10;
  coarse.crf = 35;
  mpeg4.encoder = "mpeg4";
  EXPECT_GT(fs::file_size(write("a.mp4", {96, 64}, 10, fine)), fs::file_size(write("b.mp4", {96, 64}, 10, coarse)));
  EXPECT_EQ(decode(write("c.mp4", {96, 64}, 10, mpeg4)).luma.size(), 10U);
}

TEST_F(Video, ExistsOnlyAfterFinish) {
  {
    const VideoTarget target{folder / "a.mp4", {96, 64}};
    VideoWriter video(target);
    SegmentEncoder segment(target);
    segment.push(picture(target.size, 0));
    video.append(segment.finish());
    EXPECT_FALSE(fs::exists(folder / "a.mp4"));
  }
  EXPECT_EQ(files(), 0U);
  EXPECT_THROW(VideoWriter({folder / "none" / "a.mp4", {96, 64}}), InputError);
}

}  // namespace
}  // namespace dvi::media
