#include "dvi/report/frame_block.h"

#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "dvi/media/deflate.h"

namespace dvi::report {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string to_base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  const auto byte = [&](std::size_t i) { return i < bytes.size() ? static_cast<std::uint8_t>(bytes[i]) : 0U; };
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (const int shift : {18, 12, 6, 0}) out.push_back(kDigits[three >> shift & 63]);
  }
  if (const std::size_t rest = bytes.size() % 3; rest > 0) out.replace(out.size() - (3 - rest), 3 - rest, 3 - rest, '=');
  return out;
}

/// Collects the fields of a frame's hole.
class Fields {
 public:
  explicit Fields(const cv::Mat1b& kind) : bytes_(kind.begin(), kind.end()) {
    for (std::size_t i = 0; i < bytes_.size(); ++i)
      if (bytes_[i] != 0) hole_.push_back(static_cast<int>(i));
  }

  /// Adds one value per pixel from one channel of the image.
  void add(const char* name, const cv::Mat& picture, int channel = 0) {
    if (picture.empty()) return;
    const bool wide = picture.depth() == CV_16U;
    const auto channels = static_cast<std::size_t>(picture.channels()), of = static_cast<std::size_t>(channel);
    header_ += fmt::format("{}[\"{}\",{}]", header_.empty() ? "" : ",", name, wide ? 2 : 1);
    if (!wide) {
      for (const int i : hole_) bytes_.push_back(picture.ptr<std::uint8_t>()[static_cast<std::size_t>(i) * channels + of]);
      return;
    }
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + 2 * hole_.size());
    unsigned before = 0;
    for (std::size_t k = 0; k < hole_.size(); ++k) {
      const unsigned value = picture.ptr<std::uint16_t>()[static_cast<std::size_t>(hole_[k]) * channels + of];
      bytes_[begin + k] = static_cast<std::uint8_t>(value - before);
      bytes_[begin + hole_.size() + k] = static_cast<std::uint8_t>((value - before) >> 8);
      before = value;
    }
  }

  const std::string& header() const { return header_; }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
  std::vector<int> hole_;
  std::string header_;
};

}  // namespace

std::string format_frame_block(std::size_t number, const FramePictures& pictures, const cv::Mat1b& error) {
  Fields fields(pictures.kind);
  fields.add("confidence", pictures.confidence);
  fields.add("depth", pictures.depth);
  int channel = 0;
  for (const char* name : {"source", "x", "y"}) fields.add(name, pictures.provenance, channel++);
  channel = 0;
  for (const char* name : {"red", "green", "blue"}) fields.add(name, pictures.harmonization, channel++);
  fields.add("averaged", pictures.used, 2);
  fields.add("error", error);
  return fmt::format("dvi.block({},{},{},[{}],\"{}\");\n", number, pictures.kind.cols, pictures.kind.rows, fields.header(),
                     to_base64(media::compress_zlib(fields.bytes())));
}

}  // namespace dvi::report
