#include "dvi/bags/ros_image.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/geometry/camera.h"
#include "dvi/media/image_file.h"

namespace dvi::bags {
namespace {

// The type of the pixels and their conversion to BGR from 8 bits.
struct ImageEncoding {
  int type = CV_8UC3;
  std::optional<int> conversion = {};
};

// OpenCV names a Bayer pattern by the second and third pixel of the second row, ROS by the first two pixels.
const std::map<std::string, ImageEncoding>& image_encodings() {
  static const std::map<std::string, ImageEncoding> encodings = {
      {"bgr8", {CV_8UC3, std::nullopt}},
      {"8UC3", {CV_8UC3, std::nullopt}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"8UC4", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"mono8", {CV_8UC1, cv::COLOR_GRAY2BGR}},
      {"8UC1", {CV_8UC1, cv::COLOR_GRAY2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"bgr16", {CV_16UC3, std::nullopt}},
      {"16UC3", {CV_16UC3, std::nullopt}},
      {"rgb16", {CV_16UC3, cv::COLOR_RGB2BGR}},
      {"bgra16", {CV_16UC4, cv::COLOR_BGRA2BGR}},
      {"16UC4", {CV_16UC4, cv::COLOR_BGRA2BGR}},
      {"rgba16", {CV_16UC4, cv::COLOR_RGBA2BGR}},
      {"mono16", {CV_16UC1, cv::COLOR_GRAY2BGR}},
      {"16UC1", {CV_16UC1, cv::COLOR_GRAY2BGR}},
      {"bayer_rggb16", {CV_16UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr16", {CV_16UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg16", {CV_16UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg16", {CV_16UC1, cv::COLOR_BayerGB2BGR}},
  };
  return encodings;
}

const ImageEncoding& find_encoding(const RosImage& image) {
  const auto encoding = image_encodings().find(image.encoding);
  if (encoding == image_encodings().end())
    throw std::invalid_argument(fmt::format(
        "its encoding '{}' is not supported; rgb, bgr, rgba, bgra, mono and bayer of 8 or 16 bits, uyvy, and yuyv are",
        image.encoding));
  if (encoding->second.type == CV_8UC2 && image.width % 2 != 0)
    throw std::invalid_argument(
        fmt::format("a width of {} is not possible with {}, which has pairs of pixels", image.width, image.encoding));
  return encoding->second;
}

// Returns the pixels of a message without a copy.
cv::Mat view_pixels(const RosImage& image, int type) {
  const std::uint64_t row = std::uint64_t{image.width} * CV_ELEM_SIZE(type);
  if (image.width == 0 || image.height == 0 ||
      std::uint64_t{image.width} * image.height > static_cast<std::uint64_t>(kMaxPixels))
    throw std::invalid_argument(fmt::format("a size of {}x{} pixels is not supported", image.width, image.height));
  if (image.step < row || image.data.size() < (image.height - 1) * std::uint64_t{image.step} + row)
    throw std::invalid_argument(fmt::format("{} bytes in rows of {} are not {}x{} pixels of {}", image.data.size(), image.step,
                                            image.width, image.height, image.encoding));
  return {static_cast<int>(image.height), static_cast<int>(image.width), type, const_cast<char*>(image.data.data()),
          image.step};
}

// Copies pixels of more than 8 bits, since they may be unaligned in the message and in either byte order.
cv::Mat copy_wide_pixels(const RosImage& image, int type) {
  cv::Mat bytes = view_pixels(image, CV_MAKETYPE(CV_8U, CV_ELEM_SIZE(type))).clone();
  const std::size_t size = CV_ELEM_SIZE1(type);
  if (image.is_big_endian)
    for (uchar* at = bytes.data; at != bytes.data + bytes.total() * bytes.elemSize(); at += size) std::reverse(at, at + size);
  return cv::Mat(bytes.size(), type, bytes.data).clone();
}

cv::Mat to_8_bits(const cv::Mat& image, int value_bits) {
  cv::Mat out(image.size(), CV_MAKETYPE(CV_8U, image.channels()));
  const auto* from = image.ptr<ushort>();
  for (uchar* to = out.data; to != out.data + out.total() * out.elemSize(); ++to, ++from) {
    if (*from >= 1 << value_bits)
      throw std::invalid_argument(
          fmt::format("it holds the value {}, but other images of the topic were read as {}-bit images", *from, value_bits));
    *to = static_cast<uchar>(*from >> (value_bits - 8));
  }
  return out;
}

// Converts an image to BGR with its number of bits, without transparency.
cv::Mat to_bgr_of_any_depth(const RosImage& image) {
  const auto& [type, conversion] = find_encoding(image);
  const cv::Mat raw = CV_MAT_DEPTH(type) == CV_16U ? copy_wide_pixels(image, type) : view_pixels(image, type);
  cv::Mat out;
  if (conversion)
    cv::cvtColor(raw, out, *conversion);
  else
    out = raw.clone();
  return out;
}

int find_largest(const cv::Mat& image) {
  double largest = 0;
  cv::minMaxLoc(image.reshape(1), nullptr, &largest);
  return static_cast<int>(largest);
}

// Decodes a file; returns an empty image if that is not possible.
cv::Mat decode_any_depth(const std::string& file) {
  const cv::Mat1b bytes(1, static_cast<int>(file.size()), reinterpret_cast<uchar*>(const_cast<char*>(file.data())));
  return cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
}

}  // namespace

RosImage parse_image(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosImage image{.header = take_header(fields), .encoding = {}, .data = {}};
  image.height = fields.number<std::uint32_t>();
  image.width = fields.number<std::uint32_t>();
  image.encoding = fields.text();
  image.is_big_endian = fields.number<std::uint8_t>() != 0;
  image.step = fields.number<std::uint32_t>();
  image.data = fields.bytes();
  return image;
}

bool has_16_bits(const RosImage& image) {
  const auto encoding = image_encodings().find(image.encoding);
  return encoding != image_encodings().end() && CV_MAT_DEPTH(encoding->second.type) == CV_16U;
}

int find_largest_value(const RosImage& image) { return find_largest(to_bgr_of_any_depth(image)); }

cv::Mat3b to_bgr(const RosImage& image, int value_bits) {
  const cv::Mat out = to_bgr_of_any_depth(image);
  return out.depth() == CV_16U ? to_8_bits(out, value_bits) : out;
}

bool is_depth(const RosImage& image) {
  return image.encoding == "16UC1" || image.encoding == "mono16" || image.encoding == "32FC1";
}

cv::Mat1w to_depth(const RosImage& image) {
  if (!is_depth(image))
    throw std::invalid_argument(
        fmt::format("its encoding '{}' is not supported for depth; 16UC1 and 32FC1 are", image.encoding));
  const bool meters = image.encoding == "32FC1";
  const cv::Mat raw = copy_wide_pixels(image, meters ? CV_32FC1 : CV_16UC1);
  if (!meters) return raw;
  cv::Mat1w out(raw.rows, raw.cols, ushort{0});
  constexpr float kMaxDepthM = 65.5F;
  for (int y = 0; y < raw.rows; ++y)
    for (int x = 0; x < raw.cols; ++x)
      if (const float z = raw.at<float>(y, x); z > 0 && z < kMaxDepthM)  // NaN means that nothing was measured
        out(y, x) = static_cast<ushort>(std::lround(1000 * z));
  return out;
}

bool RosCompressedImage::is_depth() const {
  return format.starts_with("16UC1") || format.starts_with("32FC1") || format.find("compressedDepth") != std::string::npos;
}

RosCompressedImage parse_compressed_image(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  take_header(fields);
  std::string format = fields.text();
  return {std::move(format), std::string(fields.bytes())};
}

RosCompressedImage parse_image_file(std::string_view message, BagEncoding encoding) {
  RosCompressedImage image = parse_compressed_image(message, encoding);
  if (!image.file.starts_with("\xFF\xD8") && !image.file.starts_with("\x89PNG"))
    throw std::invalid_argument(
        fmt::format("its {} bytes in the format '{}' are neither a JPEG nor a PNG file", image.file.size(), image.format));
  return image;
}

bool has_16_bits(const RosCompressedImage& image) {
  constexpr std::size_t kBitDepthByte = 24;  // in the header of a PNG
  return image.file.starts_with("\x89PNG") && image.file.size() > kBitDepthByte && image.file[kBitDepthByte] == 16;
}

int find_largest_value(const RosCompressedImage& image) {
  const cv::Mat decoded = decode_any_depth(image.file);
  return decoded.empty() ? 0 : find_largest(decoded);
}

cv::Mat3b to_bgr(const RosCompressedImage& image, int value_bits) {
  const cv::Mat decoded = decode_any_depth(image.file);
  if (decoded.empty()) throw std::invalid_argument("it cannot be decoded");
  return decoded.depth() == CV_16U ? to_8_bits(decoded, value_bits) : decoded;
}

cv::Mat3b convert_bayer_file(const cv::Mat3b& image, const std::string& format) {
  const std::string encoding = format.substr(0, format.find(';'));
  const auto known = image_encodings().find(encoding);
  if (!encoding.starts_with("bayer_") || known == image_encodings().end()) return image;
  std::vector<cv::Mat1b> channels;
  cv::split(image, channels);
  const bool is_gray =
      cv::norm(channels[0], channels[1], cv::NORM_INF) == 0 && cv::norm(channels[0], channels[2], cv::NORM_INF) == 0;
  if (!is_gray) return image;
  cv::Mat3b out;
  cv::cvtColor(channels[0], out, known->second.conversion.value());
  return out;
}

}  // namespace dvi::bags
