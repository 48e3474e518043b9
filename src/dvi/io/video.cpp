#include "dvi/io/video.h"

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
#include <libswscale/swscale.h>
}

#include "dvi/core/draft.h"
#include "dvi/core/error.h"

namespace dvi::io {
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
void free_scaler(SwsContext** scaler) { sws_freeContext(*scaler); }

using Format = std::unique_ptr<AVFormatContext, Release<close_format>>;
using Codec = std::unique_ptr<AVCodecContext, Release<avcodec_free_context>>;
using Picture = std::unique_ptr<AVFrame, Release<av_frame_free>>;
using Packet = std::unique_ptr<AVPacket, Release<av_packet_free>>;
using Scaler = std::unique_ptr<SwsContext, Release<free_scaler>>;

const AVCodec* find_encoder(const std::string& name) {
  const AVCodec* codec = name == "mpeg4" ? nullptr : avcodec_find_encoder_by_name("libx264");
  if (!codec && name == "h264") throw UsageError("video.encoder = h264: this libavcodec has no libx264; use mpeg4");
  return codec ? codec : avcodec_find_encoder(AV_CODEC_ID_MPEG4);
}

void describe_colours(AVCodecContext& codec) {
  codec.pix_fmt = AV_PIX_FMT_YUV420P;
  codec.color_primaries = AVCOL_PRI_BT709;
  codec.color_trc = AVCOL_TRC_BT709;
  codec.colorspace = AVCOL_SPC_BT709;
  codec.color_range = AVCOL_RANGE_MPEG;
}

Scaler make_scaler(cv::Size size) {
  Scaler scaler(sws_getContext(size.width, size.height, AV_PIX_FMT_BGR24, size.width, size.height, AV_PIX_FMT_YUV420P,
                               SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr));
  if (!scaler) throw std::runtime_error("libswscale converts no BGR to YUV 4:2:0");
  constexpr int kFullRange = 1, kVideoRange = 0, kOne = 1 << 16;
  sws_setColorspaceDetails(scaler.get(), sws_getCoefficients(SWS_CS_ITU709), kFullRange, sws_getCoefficients(SWS_CS_ITU709),
                           kVideoRange, 0, kOne, kOne);
  return scaler;
}

void repeat_last_column_and_row(AVFrame& picture, cv::Size size) {
  cv::Mat1b luma(picture.height, picture.width, picture.data[0], static_cast<std::size_t>(picture.linesize[0]));
  if (size.width < luma.cols) luma.col(size.width - 1).copyTo(luma.col(size.width));
  if (size.height < luma.rows) luma.row(size.height - 1).copyTo(luma.row(size.height));
}

}  // namespace

struct VideoWriter::Impl {
  fs::path path;
  cv::Size size;
  Draft draft{path, temporary_beside(path)};  // before `format`, which is closed first
  std::int64_t count = 0;
  Format format;
  Codec codec;
  Scaler scaler;
  Picture picture;
  Packet packet{av_packet_alloc()};
  AVStream* stream = nullptr;

  Impl(fs::path place, cv::Size frame_size) : path(std::move(place)), size(frame_size) {}

  void check(int code) const {
    if (code >= 0) return;
    std::array<char, AV_ERROR_MAX_STRING_SIZE> reason{};
    av_strerror(code, reason.data(), reason.size());
    throw InputError(path, std::string("cannot be written (") + reason.data() + ")", "free space or choose another folder");
  }

  void open(const VideoOptions& options);
  void open_encoder(const VideoOptions& options);
  void encode(const AVFrame* frame);
};

void VideoWriter::Impl::open_encoder(const VideoOptions& options) {
  const AVCodec* encoder = find_encoder(options.encoder);
  codec.reset(avcodec_alloc_context3(encoder));
  codec->width = size.width + size.width % 2;
  codec->height = size.height + size.height % 2;
  codec->framerate = av_d2q(options.fps, 1000000);
  codec->time_base = av_inv_q(codec->framerate);
  codec->thread_count = 1;  // the bytes depend on it
  codec->flags |= AV_CODEC_FLAG_BITEXACT;
  if (format->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  describe_colours(*codec);
  if (encoder->id == AV_CODEC_ID_H264) {
    check(av_opt_set(codec->priv_data, "preset", "veryfast", 0));
    check(av_opt_set_double(codec->priv_data, "crf", options.crf, 0));
    // Its AVX-512 path gave different bytes in one run of three, even with one thread.
    check(av_opt_set_int(codec->priv_data, "mbtree", 0, 0));
  } else {
    codec->flags |= AV_CODEC_FLAG_QSCALE;
    codec->global_quality = FF_QP2LAMBDA * (1 + options.crf / 6);
  }
  check(avcodec_open2(codec.get(), encoder, nullptr));
}

void VideoWriter::Impl::open(const VideoOptions& options) {
  av_log_set_level(AV_LOG_QUIET);  // what went wrong is said by the exception
  AVFormatContext* raw = nullptr;
  const std::string url = "file:" + draft.path().string();  // or libav takes what stands before a colon for a protocol
  check(avformat_alloc_output_context2(&raw, nullptr, "mp4", url.c_str()));
  format.reset(raw);
  format->flags |= AVFMT_FLAG_BITEXACT;
  open_encoder(options);
  stream = avformat_new_stream(format.get(), nullptr);
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  check(avcodec_parameters_from_context(stream->codecpar, codec.get()));

  scaler = make_scaler(size);
  picture.reset(av_frame_alloc());
  picture->format = codec->pix_fmt;
  picture->width = codec->width;
  picture->height = codec->height;
  check(av_frame_get_buffer(picture.get(), 0));

  check(avio_open(&format->pb, format->url, AVIO_FLAG_WRITE));
  AVDictionary* muxer = nullptr;
  av_dict_set(&muxer, "movflags", "+faststart", 0);
  const int code = avformat_write_header(format.get(), &muxer);
  av_dict_free(&muxer);
  check(code);
}

/// A frame, or none to flush.
void VideoWriter::Impl::encode(const AVFrame* frame) {
  check(avcodec_send_frame(codec.get(), frame));
  for (;;) {
    const int code = avcodec_receive_packet(codec.get(), packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
    check(code);
    packet->duration = 1;
    av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
    packet->stream_index = stream->index;
    check(av_interleaved_write_frame(format.get(), packet.get()));
    check(format->pb->error);
  }
}

VideoWriter::VideoWriter(const fs::path& path, cv::Size size, const VideoOptions& options)
    : impl_(std::make_unique<Impl>(path, size)) {
  impl_->open(options);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::push(const cv::Mat3b& frame) {
  Impl& s = *impl_;
  if (frame.size() != s.size) throw std::logic_error("a video's frames are of one size");
  s.check(av_frame_make_writable(s.picture.get()));
  const std::array<const std::uint8_t*, 1> data{frame.data};
  const std::array<int, 1> stride{static_cast<int>(frame.step[0])};
  sws_scale(s.scaler.get(), data.data(), stride.data(), 0, frame.rows, s.picture->data, s.picture->linesize);
  repeat_last_column_and_row(*s.picture, s.size);
  s.picture->pts = s.count++;
  s.encode(s.picture.get());
}

void VideoWriter::finish() {
  Impl& s = *impl_;
  s.encode(nullptr);
  s.check(av_write_trailer(s.format.get()));
  s.check(avio_closep(&s.format->pb));
  s.draft.finish();
}

}  // namespace dvi::io
