#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/bags/bag.h"
#include "dvi/geometry/se3.h"

namespace dvi::bags {

/// Reads the fields of a ROS message from bytes in CDR or in the encoding of ROS 1. Throws std::invalid_argument if they are
/// truncated or of another encoding.
class RosFields {
 public:
  RosFields(std::string_view bytes, BagEncoding encoding);

  template <class T>
  T number() {
    T value;
    const std::string_view raw = take(sizeof(T), sizeof(T));
    std::memcpy(&value, raw.data(), sizeof(T));
    if (swap_) std::reverse(reinterpret_cast<char*>(&value), reinterpret_cast<char*>(&value) + sizeof(T));
    return value;
  }
  std::string text();
  std::string_view bytes();  ///< reads an array of bytes
  template <std::size_t N>
  std::array<double, N> numbers() {
    std::array<double, N> out;
    for (double& value : out) value = number<double>();
    return out;
  }
  std::vector<double> list();
  /// Reads the length of a list whose items have at least `item_bytes` bytes each.
  std::uint32_t length(std::size_t item_bytes);
  /// Returns the number of bytes from the beginning of the message to the end of the last field that was read.
  std::size_t position() const { return all_.data() - message_ + at_; }
  BagEncoding encoding() const { return encoding_; }
  bool is_big_endian() const { return swap_; }

 private:
  std::string_view take(std::size_t count, std::size_t alignment);

  const char* message_;
  std::string_view all_;  // without the head of CDR
  std::size_t at_ = 0;
  BagEncoding encoding_;
  bool swap_ = false;
};

/// Returns the bytes of a number or of an array's length, in the byte order of a message.
std::string to_field(std::uint32_t value, bool is_big_endian);

/// std_msgs/Header. The frame is without a leading '/'.
struct RosHeader {
  std::int64_t stamp_ns = 0;  ///< 0: not set
  std::string frame;
};
RosHeader take_header(RosFields& fields);
/// Reads the header of any message that begins with one.
RosHeader read_header(std::string_view message, BagEncoding encoding);

/// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  RosHeader header;
  int width = 0, height = 0;
  std::string model;
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
};
RosCameraInfo parse_camera_info(std::string_view message, BagEncoding encoding);

/// A motion between two named frames, of tf, nav_msgs/Odometry, or a stamped pose (which has no child).
struct RosMotion {
  RosHeader header;
  std::string child;
  SE3 parent_from_child;
  bool valid = true;  ///< false if its quaternion does not have length 1 or its translation is not finite
};
/// Parses tf. Keeps invalid motions, which tf2 ignores as well. The other two functions refuse them (std::invalid_argument).
std::vector<RosMotion> parse_tf(std::string_view message, BagEncoding encoding);
RosMotion parse_odometry(std::string_view message, BagEncoding encoding);
RosMotion parse_pose(std::string_view message, BagEncoding encoding);

/// sensor_msgs/NavSatFix.
struct RosFix {
  RosHeader header;
  bool valid = false;  ///< whether the receiver had a fix
  double latitude_deg = 0, longitude_deg = 0;
};
RosFix parse_fix(std::string_view message, BagEncoding encoding);

}  // namespace dvi::bags
