#include "dvi/media/video.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavcodec/codec.h>
#include <libavcodec/codec_id.h>
#include <libavcodec/packet.h>
#include <libavformat/avformat.h>
#include <libavformat/avio.h>
#include <libavutil/avutil.h>
#include <libavutil/dict.h>
#include <libavutil/error.h>
#include <libavutil/frame.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
#include <libavutil/pixfmt.h>
#include <libavutil/rational.h>
}

#include "dvi/core/draft.h"
#include "dvi/core/error.h"

namespace dvi::media {
namespace {

template <auto FreeFunction>
struct Release {
  template <class T>
  void operator()(T* object) const {
    FreeFunction(&object);
  }
};
void close_format(AVFormatContext** format) {
  if ((*format)->pb) avio_closep(&(*format)->pb);
  avformat_free_context(*format);
}

using Format = std::unique_ptr<AVFormatContext, Release<close_format>>;
using Codec = std::unique_ptr<AVCodecContext, Release<avcodec_free_context>>;
using Picture = std::unique_ptr<AVFrame, Release<av_frame_free>>;
using Packet = std::unique_ptr<AVPacket, Release<av_packet_free>>;

const AVCodec* find_encoder(const std::string& name) {
  const AVCodec* codec = name == "mpeg4" ? nullptr : avcodec_find_encoder_by_name("libx264");
  if (!codec && name == "h264") throw UsageError("video.encoder = h264: the installed libavcodec has no libx264; use mpeg4");
  return codec ? codec : avcodec_find_encoder(AV_CODEC_ID_MPEG4);
}

void describe_colors(AVCodecContext& codec) {
  codec.pix_fmt = AV_PIX_FMT_YUV420P;
  codec.color_primaries = AVCOL_PRI_BT709;
  codec.color_trc = AVCOL_TRC_BT709;
  codec.colorspace = AVCOL_SPC_BT709;
  codec.color_range = AVCOL_RANGE_MPEG;
  codec.chroma_sample_location = AVCHROMA_LOC_CENTER;
}

int round_up_to_even(int size) { return size + size % 2; }

/// The weights of full-range B, G, R in video-range Y, Cb, Cr of BT.709, in units of 2^-16.
constexpr std::array<int, 3> kLuma{4064, 40254, 11966}, kBlue{28784, -22188, -6596}, kRed{-2639, -26145, 28784};

uchar apply_weights(const std::array<int, 3>& weights, const std::array<int, 3>& bgr, int offset, int shift) {
  const int sum = weights[0] * bgr[0] + weights[1] * bgr[1] + weights[2] * bgr[2];
  return static_cast<uchar>((sum + (offset << shift) + (1 << (shift - 1))) >> shift);
}

/// Converts an image into rows `top` and following of the planes of a picture. Chroma is the mean of 2 x 2 pixels. Odd sizes
/// repeat the last column and row.
void convert(const cv::Mat3b& image, AVFrame& picture, int top) {
  const auto row_of = [&](int plane, int y) {
    return picture.data[plane] + static_cast<std::ptrdiff_t>(y) * picture.linesize[plane];
  };
  for (int y = 0; y < image.rows; y += 2) {
    const std::array<const cv::Vec3b*, 2> in{image[y], image[std::min(y + 1, image.rows - 1)]};
    const std::array<uchar*, 2> luma{row_of(0, top + y), row_of(0, top + y + 1)};
    uchar *blue = row_of(1, (top + y) / 2), *red = row_of(2, (top + y) / 2);
    for (int x = 0; x < image.cols; x += 2) {
      std::array<int, 3> sum{};
      for (const int row : {0, 1})
        for (const int column : {x, x + 1}) {
          const cv::Vec3b& bgr = in[row][std::min(column, image.cols - 1)];
          luma[row][column] = apply_weights(kLuma, {bgr[0], bgr[1], bgr[2]}, 16, 16);
          for (int c = 0; c < 3; ++c) sum[c] += bgr[c];
        }
      blue[x / 2] = apply_weights(kBlue, sum, 128, 18);
      red[x / 2] = apply_weights(kRed, sum, 128, 18);
    }
  }
}

void check(int code, const fs::path& path) {
  if (code >= 0) return;
  std::array<char, AV_ERROR_MAX_STRING_SIZE> reason{};
  av_strerror(code, reason.data(), reason.size());
  throw InputError(path, std::string("cannot be written (") + reason.data() + ")", "free space or choose another folder");
}

Codec open_encoder(const VideoTarget& target) {
  av_log_set_level(AV_LOG_QUIET);  // exceptions report errors
  const AVCodec* encoder = find_encoder(target.options.encoder);
  Codec codec(avcodec_alloc_context3(encoder));
  codec->width = round_up_to_even(target.size.width);
  codec->height = round_up_to_even(target.size.height);
  codec->framerate = av_d2q(target.options.fps, 1000000);
  codec->time_base = av_inv_q(codec->framerate);
  codec->thread_count = 1;  // the bytes depend on the number of threads
  // The format mp4 has one header for all frames.
  codec->flags |= AV_CODEC_FLAG_BITEXACT | AV_CODEC_FLAG_GLOBAL_HEADER;
  describe_colors(*codec);
  if (encoder->id == AV_CODEC_ID_H264) {
    check(av_opt_set(codec->priv_data, "preset", "veryfast", 0), target.path);
    check(av_opt_set_double(codec->priv_data, "crf", target.options.crf, 0), target.path);
    // Macroblock trees make the bytes differ between runs, most often if two encoders work at the same time.
    check(av_opt_set_int(codec->priv_data, "mbtree", 0, 0), target.path);
    // In short segments, B frames and the lookahead save no bytes, and keep many frames in memory.
    codec->max_b_frames = 0;
    check(av_opt_set_int(codec->priv_data, "rc-lookahead", 0, 0), target.path);
  } else {
    codec->flags |= AV_CODEC_FLAG_QSCALE;
    codec->global_quality = FF_QP2LAMBDA * (1 + target.options.crf / 6);
  }
  check(avcodec_open2(codec.get(), encoder, nullptr), target.path);
  return codec;
}

}  // namespace

struct SegmentEncoder::Impl {
  VideoTarget target;
  Codec codec;
  Picture picture;
  std::int64_t frames = 0;
  VideoSegment encoded;

  explicit Impl(const VideoTarget& of) : target(of), codec(open_encoder(of)), picture(av_frame_alloc()) {
    picture->format = codec->pix_fmt;
    picture->width = codec->width;
    picture->height = codec->height;
    check(av_frame_get_buffer(picture.get(), 0), target.path);
  }

  void encode(const AVFrame* frame);
};

/// Encodes a frame, or flushes the encoder if there is none.
void SegmentEncoder::Impl::encode(const AVFrame* frame) {
  check(avcodec_send_frame(codec.get(), frame), target.path);
  for (;;) {
    Packet packet(av_packet_alloc());
    const int code = avcodec_receive_packet(codec.get(), packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
    check(code, target.path);
    encoded.push_back({(packet->flags & AV_PKT_FLAG_KEY) != 0, {packet->data, packet->data + packet->size}});
  }
}

SegmentEncoder::SegmentEncoder(const VideoTarget& target) : impl_(std::make_unique<Impl>(target)) {}
SegmentEncoder::~SegmentEncoder() = default;

void SegmentEncoder::push(const cv::Mat3b& frame) { push_stacked({frame}); }

void SegmentEncoder::push_stacked(const std::vector<cv::Mat3b>& images) {
  Impl& s = *impl_;
  int height = 0;
  for (const cv::Mat3b& image : images) height += round_up_to_even(image.rows);
  for (const cv::Mat3b& image : images)
    if (image.cols != s.target.size.width || height != round_up_to_even(s.target.size.height))
      throw std::logic_error("all frames of a video must have the same size");
  check(av_frame_make_writable(s.picture.get()), s.target.path);
  int top = 0;
  for (const cv::Mat3b& image : images) {
    convert(image, *s.picture, top);
    top += round_up_to_even(image.rows);
  }
  s.picture->pts = s.frames++;
  s.encode(s.picture.get());
}

VideoSegment SegmentEncoder::finish() {
  impl_->encode(nullptr);
  return std::move(impl_->encoded);
}

struct VideoWriter::Impl {
  VideoTarget target;
  Draft draft{target.path, temporary_beside(target.path)};  // declared before `format`, which has to be closed first
  std::int64_t count = 0;
  Format format;
  AVRational time_base{};  // duration of a frame in seconds
  AVStream* stream = nullptr;

  explicit Impl(VideoTarget of) : target(std::move(of)) {}

  void open();
};

void VideoWriter::Impl::open() {
  const fs::path& path = target.path;
  const Codec codec = open_encoder(target);
  AVFormatContext* raw = nullptr;
  const std::string url = "file:" + draft.path().string();  // otherwise libav reads the part before a colon as a protocol
  check(avformat_alloc_output_context2(&raw, nullptr, "mp4", url.c_str()), path);
  format.reset(raw);
  format->flags |= AVFMT_FLAG_BITEXACT;
  time_base = codec->time_base;
  stream = avformat_new_stream(format.get(), nullptr);
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  check(avcodec_parameters_from_context(stream->codecpar, codec.get()), path);

  check(avio_open(&format->pb, format->url, AVIO_FLAG_WRITE), path);
  AVDictionary* muxer = nullptr;
  av_dict_set(&muxer, "movflags", "+faststart", 0);
  const int code = avformat_write_header(format.get(), &muxer);
  av_dict_free(&muxer);
  check(code, path);
}

VideoWriter::VideoWriter(const VideoTarget& target) : impl_(std::make_unique<Impl>(target)) { impl_->open(); }

VideoWriter::~VideoWriter() = default;

void VideoWriter::append(const VideoSegment& segment) {
  Impl& s = *impl_;
  const Packet packet(av_packet_alloc());
  for (const EncodedFrame& frame : segment) {
    check(av_new_packet(packet.get(), static_cast<int>(frame.bytes.size())), s.target.path);
    std::copy(frame.bytes.begin(), frame.bytes.end(), packet->data);
    packet->flags = frame.is_key ? AV_PKT_FLAG_KEY : 0;
    packet->pts = packet->dts = s.count++;  // no encoder reorders frames
    packet->duration = 1;
    av_packet_rescale_ts(packet.get(), s.time_base, s.stream->time_base);
    packet->stream_index = s.stream->index;
    check(av_interleaved_write_frame(s.format.get(), packet.get()), s.target.path);
    check(s.format->pb->error, s.target.path);
  }
}

void VideoWriter::finish() {
  Impl& s = *impl_;
  check(av_write_trailer(s.format.get()), s.target.path);
  check(avio_closep(&s.format->pb), s.target.path);
  s.draft.finish();
}

std::vector<FrameSpan> divide_into_segments(std::size_t frames) {
  constexpr std::size_t kSegmentFrames = 16;
  std::vector<FrameSpan> segments;
  for (std::size_t first = 0; first < frames; first += kSegmentFrames)
    segments.push_back({first, std::min(first + kSegmentFrames, frames)});
  return segments;
}

}  // namespace dvi::media
