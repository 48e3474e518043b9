#include "dvi/media/video_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavcodec/codec.h>
#include <libavcodec/codec_par.h>
#include <libavcodec/defs.h>
#include <libavcodec/packet.h>
#include <libavformat/avformat.h>
#include <libavutil/avutil.h>
#include <libavutil/display.h>
#include <libavutil/error.h>
#include <libavutil/frame.h>
#include <libavutil/log.h>
#include <libavutil/mathematics.h>
#include <libavutil/pixfmt.h>
#include <libavutil/rational.h>
#include <libswscale/swscale.h>
}

#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/text.h"

namespace dvi::media {
namespace {

template <auto FreeFunction>
struct Releaser {
  template <class T>
  void operator()(T* object) const {
    FreeFunction(&object);
  }
};
void free_scaler(SwsContext** scaler) { sws_freeContext(*scaler); }

using Input = std::unique_ptr<AVFormatContext, Releaser<avformat_close_input>>;
using DecoderContext = std::unique_ptr<AVCodecContext, Releaser<avcodec_free_context>>;
using DecodedPicture = std::unique_ptr<AVFrame, Releaser<av_frame_free>>;
using ReadPacket = std::unique_ptr<AVPacket, Releaser<av_packet_free>>;
using Scaler = std::unique_ptr<SwsContext, Releaser<free_scaler>>;

std::string describe_error(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  return av_make_error_string(text.data(), text.size(), code);
}

/// An opened file and its stream of frames.
struct OpenedVideo {
  explicit OpenedVideo(const fs::path& file) {
    av_log_set_level(AV_LOG_QUIET);
    AVFormatContext* raw = nullptr;
    if (const int code = avformat_open_input(&raw, file.c_str(), nullptr, nullptr); code < 0)
      throw InputError(file, "is not a video that can be read (" + describe_error(code) + ")",
                       "the file may be truncated, or still being written");
    input.reset(raw);
    if (const int code = avformat_find_stream_info(input.get(), nullptr); code < 0)
      throw InputError(file, "is not a video that can be read (" + describe_error(code) + ")");
    const int found = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (found < 0 || codec == nullptr) throw InputError(file, "holds no video that libav can decode", "write it as H.264");
    stream = input->streams[found];
    for (unsigned i = 0; i < input->nb_streams; ++i)
      if (static_cast<int>(i) != found) input->streams[i]->discard = AVDISCARD_ALL;
  }
  bool is_frame(const AVPacket& packet) const {
    return packet.stream_index == stream->index && (packet.flags & AV_PKT_FLAG_DISCARD) == 0;
  }

  Input input;
  const AVCodec* codec = nullptr;
  AVStream* stream = nullptr;
};

/// An encoded frame, in the stream's units of time.
struct CodedFrame {
  std::int64_t shown = 0;    ///< presentation time
  std::int64_t decoded = 0;  ///< decoding order
  bool key = false;          ///< whether decoding can begin here
};

// Compares with the duration that the container states at its beginning, if it is that of the video.
bool ends_early(const OpenedVideo& video, const std::vector<CodedFrame>& frames) {
  constexpr int kMaxMissingFrames = 3;
  constexpr double kMaxRateRatio = 1.05;  // the rate may vary
  if (video.input->nb_streams != 1 || video.input->duration_estimation_method != AVFMT_DURATION_FROM_STREAM) return false;
  const auto by_time = [](const CodedFrame& a, const CodedFrame& b) { return a.shown < b.shown; };
  const auto [first, last] = std::minmax_element(frames.begin(), frames.end(), by_time);
  const double second = 1 / av_q2d(video.stream->time_base), told = static_cast<double>(video.input->duration) / AV_TIME_BASE;
  const double seen = static_cast<double>(last->shown - first->shown) / second;
  return told >
         kMaxRateRatio * seen + kMaxMissingFrames * seen / static_cast<double>(std::max<std::size_t>(frames.size(), 2) - 1);
}

// Returns the display matrix of the stream, or null if it has none. FFmpeg 6.1 moved it to the parameters of the codec.
const std::int32_t* find_display_matrix(const AVStream& stream) {
  constexpr std::size_t kMatrixBytes = 9 * sizeof(std::int32_t);
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 102)
  const AVCodecParameters& codec = *stream.codecpar;
  const AVPacketSideData* found =
      av_packet_side_data_get(codec.coded_side_data, codec.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  if (found == nullptr || found->size < kMatrixBytes) return nullptr;
  return reinterpret_cast<const std::int32_t*>(found->data);
#else
  std::size_t bytes = 0;
  const std::uint8_t* data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
  return data == nullptr || bytes < kMatrixBytes ? nullptr : reinterpret_cast<const std::int32_t*>(data);
#endif
}

// The display matrix rotates counterclockwise.
int read_rotation_deg(const AVStream& stream) {
  const std::int32_t* matrix = find_display_matrix(stream);
  if (matrix == nullptr) return 0;
  const double turned = av_display_rotation_get(matrix);
  if (!std::isfinite(turned)) return 0;
  return (360 - static_cast<int>(std::lround(turned)) % 360) % 360;
}

/// Lists the frames in the order of the file.
std::vector<CodedFrame> list_frames(const fs::path& file, const OpenedVideo& video) {
  std::vector<CodedFrame> frames;
  const ReadPacket packet(av_packet_alloc());
  int code = av_read_frame(video.input.get(), packet.get());
  for (; code >= 0; code = av_read_frame(video.input.get(), packet.get())) {
    if (video.is_frame(*packet)) {
      const bool reordered = video.stream->codecpar->video_delay > 0;  // then only pts is the presentation time
      const std::int64_t shown = packet->pts != AV_NOPTS_VALUE || reordered ? packet->pts : packet->dts;
      if (shown == AV_NOPTS_VALUE) throw InputError(file, "does not state the times of its frames", "write it as .mp4 or .mkv");
      if ((packet->flags & AV_PKT_FLAG_CORRUPT) != 0)
        throw InputError(file, "is damaged at frame " + std::to_string(frames.size()),
                         "the file may be truncated; write it again");
      frames.push_back({shown, packet->dts != AV_NOPTS_VALUE ? packet->dts : shown, (packet->flags & AV_PKT_FLAG_KEY) != 0});
    }
    av_packet_unref(packet.get());
  }
  const std::int64_t promised = video.stream->nb_frames;  // 0 if the container states no number
  if (code != AVERROR_EOF || std::cmp_less(frames.size(), promised))
    throw InputError(
        file,
        "ends after " + std::to_string(frames.size()) + (promised > 0 ? " of its " + std::to_string(promised) : "") + " frames",
        "the file is truncated; write it again");
  if (frames.empty()) throw InputError(file, "holds no frames");
  if (ends_early(video, frames))
    throw InputError(file, "ends after " + std::to_string(frames.size()) + " frames, long before its stated duration",
                     "the file is truncated; write it again");
  return frames;
}

/// A decoder at some position of the video.
class Decoder {
 public:
  explicit Decoder(const fs::path& file) : file_(file), video_(file), codec_(avcodec_alloc_context3(video_.codec)) {
    codec_->thread_count = 1;
    if (avcodec_parameters_to_context(codec_.get(), video_.stream->codecpar) < 0 ||
        avcodec_open2(codec_.get(), video_.codec, nullptr) < 0)
      throw InputError(file, "cannot be decoded", "write it as H.264");
  }
  /// Returns the time of the frame that was decoded last; nothing before the first one.
  std::optional<std::int64_t> last() const { return last_; }

  /// Moves to a key frame. Returns false if reading cannot begin there.
  bool seek(const CodedFrame& key) {
    last_.reset();
    avcodec_flush_buffers(codec_.get());
    if (avformat_seek_file(video_.input.get(), video_.stream->index, INT64_MIN, key.decoded, key.decoded, 0) < 0) return false;
    do {
      if (!read()) return false;
    } while (packet_->dts < key.decoded && packet_->dts != AV_NOPTS_VALUE);
    pending_ = true;
    return packet_->pts == key.shown || packet_->pts == AV_NOPTS_VALUE;
  }
  /// Decodes the picture shown at a time after last(); returns null if there is none.
  const AVFrame* at(std::int64_t shown) {
    while (true) {
      const int code = avcodec_receive_frame(codec_.get(), picture_.get());
      if (code == 0) {
        last_ = picture_->best_effort_timestamp;
        if (*last_ == shown) return picture_.get();
        if (*last_ > shown) return nullptr;
        continue;
      }
      if (code == AVERROR_EOF) return nullptr;
      if (code != AVERROR(EAGAIN)) fail(describe_error(code));
      if (!pending_ && !read()) {
        avcodec_send_packet(codec_.get(), nullptr);
        continue;
      }
      pending_ = false;
      if (const int sent = avcodec_send_packet(codec_.get(), packet_.get()); sent < 0 && sent != AVERROR_EOF)
        fail(describe_error(sent));
    }
  }

 private:
  bool read() {
    do {
      av_packet_unref(packet_.get());
      if (av_read_frame(video_.input.get(), packet_.get()) < 0) return false;
    } while (!video_.is_frame(*packet_));
    return true;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(file_, "cannot be decoded (" + why + ")", "write it again");
  }

  fs::path file_;
  OpenedVideo video_;
  DecoderContext codec_;
  DecodedPicture picture_{av_frame_alloc()};
  ReadPacket packet_{av_packet_alloc()};
  bool pending_ = false;
  std::optional<std::int64_t> last_;
};

// An unspecified color space is assumed by the size, as in players.
int find_color_space(const AVFrame& picture) {
  if (picture.colorspace != AVCOL_SPC_UNSPECIFIED && picture.colorspace != AVCOL_SPC_RGB) return picture.colorspace;
  constexpr int kHighDefinition = 720;
  return picture.height >= kHighDefinition ? SWS_CS_ITU709 : SWS_CS_ITU601;
}

cv::Mat3b to_bgr(const AVFrame& picture, const fs::path& file) {
  const Scaler scaler(sws_getContext(
      picture.width, picture.height, static_cast<AVPixelFormat>(picture.format), picture.width, picture.height,
      AV_PIX_FMT_BGR24, SWS_BILINEAR | SWS_FULL_CHR_H_INT | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr));
  if (!scaler) throw InputError(file, "has a pixel format that cannot be converted", "write it as H.264 in yuv420p");
  const bool full_range = picture.color_range == AVCOL_RANGE_JPEG;
  constexpr int kOne = 1 << 16;
  sws_setColorspaceDetails(scaler.get(), sws_getCoefficients(find_color_space(picture)), full_range ? 1 : 0,
                           sws_getCoefficients(SWS_CS_DEFAULT), 1, 0, kOne, kOne);
  cv::Mat3b out(picture.height, picture.width);
  const std::array<std::uint8_t*, 1> rows{out.data};
  const std::array<int, 1> step{static_cast<int>(out.step)};
  if (sws_scale(scaler.get(), picture.data, picture.linesize, 0, picture.height, rows.data(), step.data()) != picture.height)
    throw InputError(file, "has a picture that cannot be converted", "write it as H.264 in yuv420p");
  return out;
}

}  // namespace

const std::vector<std::string> kVideoEndings = {".mp4", ".mkv", ".mov", ".avi"};

bool is_video(const fs::path& file) {
  const std::string ending = to_lower_case(file.extension().string());
  return std::find(kVideoEndings.begin(), kVideoEndings.end(), ending) != kVideoEndings.end();
}

struct VideoReader::Impl {
  fs::path file;
  cv::Size size;
  int rotation_deg = 0;
  std::vector<std::int64_t> times_ns, shown;  ///< in order of time
  std::vector<CodedFrame> keys;               ///< in order of time
  std::mutex mutex;
  std::vector<std::unique_ptr<Decoder>> idle;

  /// Finds the last key frame that is not shown after a time.
  std::vector<CodedFrame>::const_iterator key_of(std::int64_t time) const {
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), time, [](std::int64_t t, const CodedFrame& key) { return t < key.shown; });
    return after == keys.begin() ? after : std::prev(after);
  }
  /// Takes a decoder that is shortly before a frame, if there is one, or any other.
  std::unique_ptr<Decoder> take(std::int64_t time, std::int64_t key) {
    const std::lock_guard lock(mutex);
    if (idle.empty()) return nullptr;
    const auto fits = [&](const std::unique_ptr<Decoder>& d) { return d->last() && *d->last() >= key && *d->last() < time; };
    const auto best = std::max_element(idle.begin(), idle.end(), [&](const auto& a, const auto& b) {
      return (fits(a) ? *a->last() : INT64_MIN) < (fits(b) ? *b->last() : INT64_MIN);
    });
    std::unique_ptr<Decoder> out = std::move(*best);
    idle.erase(best);
    return out;
  }
  void give_back(std::unique_ptr<Decoder> decoding) {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(decoding));
  }
  /// Decodes from the key frame before a time or, if that fails, from the beginning.
  const AVFrame* find(std::unique_ptr<Decoder>& decoding, std::int64_t time) const {
    const auto key = key_of(time);
    if (decoding && decoding->last() && *decoding->last() >= key->shown && *decoding->last() < time)
      if (const AVFrame* found = decoding->at(time)) return found;
    if (!decoding) decoding = std::make_unique<Decoder>(file);
    if (decoding->seek(*key))
      if (const AVFrame* found = decoding->at(time)) return found;
    decoding = std::make_unique<Decoder>(file);
    return decoding->at(time);
  }
};

VideoReader::VideoReader(fs::path file) : impl_(std::make_unique<Impl>()) {
  constexpr AVRational kNanosecond{1, 1'000'000'000};
  impl_->file = std::move(file);
  require_regular_file(impl_->file, UINTMAX_MAX);
  const OpenedVideo video(impl_->file);
  impl_->size = {video.stream->codecpar->width, video.stream->codecpar->height};
  impl_->rotation_deg = read_rotation_deg(*video.stream);
  for (const CodedFrame& frame : list_frames(impl_->file, video)) {
    impl_->shown.push_back(frame.shown);
    if (frame.key) impl_->keys.push_back(frame);
  }
  if (impl_->keys.empty()) throw InputError(impl_->file, "holds no key frame", "write it again");
  const auto by_time = [](const CodedFrame& a, const CodedFrame& b) { return a.shown < b.shown; };
  std::sort(impl_->shown.begin(), impl_->shown.end());
  std::sort(impl_->keys.begin(), impl_->keys.end(), by_time);
  for (const std::int64_t shown : impl_->shown)
    impl_->times_ns.push_back(av_rescale_q(shown - impl_->shown.front(), video.stream->time_base, kNanosecond));
}

VideoReader::~VideoReader() = default;

cv::Size VideoReader::size() const { return impl_->size; }
int VideoReader::rotation_deg() const { return impl_->rotation_deg; }
const std::vector<std::int64_t>& VideoReader::times_ns() const { return impl_->times_ns; }

cv::Mat3b VideoReader::operator[](std::size_t i) const {
  const std::int64_t time = impl_->shown[i];
  std::unique_ptr<Decoder> decoding = impl_->take(time, impl_->key_of(time)->shown);
  const AVFrame* picture = impl_->find(decoding, time);
  const std::string frame = "frame " + std::to_string(i);
  if (picture == nullptr || picture->decode_error_flags != 0 || (picture->flags & AV_FRAME_FLAG_CORRUPT) != 0)
    throw InputError(impl_->file, frame + " is damaged", "the file may be truncated; write it again");
  if (picture->width != impl_->size.width || picture->height != impl_->size.height)
    throw InputError(impl_->file, frame + " differs in size from the first one", "all frames must have the same size");
  cv::Mat3b out = to_bgr(*picture, impl_->file);
  impl_->give_back(std::move(decoding));
  return out;
}

}  // namespace dvi::media
