#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "dvi/bags/ros_message.h"

namespace dvi::bags {

/// sensor_msgs/Image before its pixels are converted.
struct RosImage {
  RosHeader header;
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool is_big_endian = false;  ///< pixels of more than 8 bits
  std::string_view data;       ///< of the message
};
RosImage parse_image(std::string_view message, BagEncoding encoding);

/// Whether its pixels are colors or gray of 16 bits, of which cameras often use 10, 12, or 14.
bool has_16_bits(const RosImage& image);

/// The largest value of its colors. std::invalid_argument as to_bgr().
int find_largest_value(const RosImage& image);

/// Its colors, also of depth images. Of pixels of 16 bits only `value_bits` are in use: these are scaled to 8 bits.
/// std::invalid_argument where its encoding is not known, data are missing, or a value needs more bits.
cv::Mat3b to_bgr(const RosImage& image, int value_bits = 16);

/// Depth in millimeters, 0 where there is none, of a sensor_msgs/Image of 16UC1 (millimeters) or 32FC1 (meters).
/// std::invalid_argument as to_bgr().
cv::Mat1w to_depth(const RosImage& image);
/// Whether it may be depth by its encoding; mono16 can be either depth or gray.
bool is_depth(const RosImage& image);

/// sensor_msgs/CompressedImage: a file, and what image_transport says of the image in it.
struct RosCompressedImage {
  std::string format;  ///< "rgb8; jpeg compressed bgr8", or only "jpeg"
  std::string file;

  /// Whether it holds depth, by its format.
  bool is_depth() const;
};
RosCompressedImage parse_compressed_image(std::string_view message, BagEncoding encoding);

/// The same of a file that is read: PNG or JPEG. std::invalid_argument where it is another.
RosCompressedImage parse_image_file(std::string_view message, BagEncoding encoding);

/// Whether a file is a PNG of 16 bits; the largest of its colors; and these by the bits in use, as for RosImage.
bool has_16_bits(const RosCompressedImage& image);
int find_largest_value(const RosCompressedImage& image);
cv::Mat3b to_bgr(const RosCompressedImage& image, int value_bits);

/// The colors of a decoded file. Files of Bayer patterns, which image_transport stores as gray, are converted.
cv::Mat3b convert_bayer_file(const cv::Mat3b& image, const std::string& format);

}  // namespace dvi::bags
