#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "dvi/bags/ros_message.h"
#include "dvi/media/image_edit.h"

namespace dvi::bags {

/// A sensor_msgs/Image before its pixels are converted.
struct RosImage {
  RosHeader header;
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool is_big_endian = false;  ///< byte order of pixels of more than 8 bits
  std::string_view data;       ///< a view into the message
};
RosImage parse_image(std::string_view message, BagEncoding encoding);

/// Returns whether the pixels are colors or gray of 16 bits, of which cameras often use only 10, 12, or 14.
bool has_16_bits(const RosImage& image);

/// Returns the largest value of the colors. Throws the same errors as to_bgr().
int find_largest_value(const RosImage& image);

/// Converts an image to 8-bit BGR, also a depth image. 16-bit pixels, of which only `value_bits` are used, are scaled to 8
/// bits. Throws std::invalid_argument if the encoding is not supported, data are missing, or a value needs more bits.
cv::Mat3b to_bgr(const RosImage& image, int value_bits = 16);

/// Converts a sensor_msgs/Image of 16UC1 (millimeters) or 32FC1 (meters) to depth in millimeters, 0 if there is none. Throws
/// the same errors as to_bgr().
cv::Mat1w to_depth(const RosImage& image);
/// Returns whether an image may be depth by its encoding; mono16 can be depth or gray.
bool is_depth(const RosImage& image);

/// A sensor_msgs/CompressedImage: a file, and the description of its image by image_transport.
struct RosCompressedImage {
  std::string format;  ///< "rgb8; jpeg compressed bgr8", or only "jpeg"
  std::string file;

  /// Returns whether it holds depth, by its format.
  bool is_depth() const;
};
RosCompressedImage parse_compressed_image(std::string_view message, BagEncoding encoding);

/// Parses a message with a PNG or JPEG file. Throws std::invalid_argument if it has another format.
RosCompressedImage parse_image_file(std::string_view message, BagEncoding encoding);

/// Do the same for a file as the functions above for a RosImage.
bool has_16_bits(const RosCompressedImage& image);
int find_largest_value(const RosCompressedImage& image);
cv::Mat3b to_bgr(const RosCompressedImage& image, int value_bits);

/// Returns the colors of a decoded file. Converts Bayer patterns, which image_transport stores as gray.
cv::Mat3b convert_bayer_file(const cv::Mat3b& image, const std::string& format);

/// Applies an edit to a sensor_msgs/Image of 8-bit gray, BGR, RGB, BGRA, or RGBA; all other bytes are kept. Returns nothing if
/// the edit was not made for this image. Throws std::invalid_argument for other encodings, whose pixels cannot be written back.
std::optional<std::string> edit_image(std::string message, BagEncoding encoding, const media::ImageEdit& edit);

/// Applies an edit to the file in a sensor_msgs/CompressedImage, as media::edit_image_file() does; header and format are kept.
/// Throws std::invalid_argument for other formats and for Bayer patterns.
std::optional<std::string> edit_compressed_image(std::string_view message, BagEncoding encoding, const media::ImageEdit& edit,
                                                 int jpeg_quality);

}  // namespace dvi::bags
