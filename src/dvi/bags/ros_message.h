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

/// Takes the fields of a ROS message off its bytes, as CDR or as ROS 1 lay them out. std::invalid_argument where they end too
/// early or are of another kind.
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
  std::string_view bytes();  ///< of an array of bytes
  template <std::size_t N>
  std::array<double, N> numbers() {
    std::array<double, N> out;
    for (double& value : out) value = number<double>();
    return out;
  }
  std::vector<double> list();
  /// The length of a list, of whose items each takes so many bytes at least.
  std::uint32_t length(std::size_t item_bytes);
  BagEncoding encoding() const { return encoding_; }

 private:
  std::string_view take(std::size_t count, std::size_t alignment);

  std::string_view all_;
  std::size_t at_ = 0;
  BagEncoding encoding_;
  bool swap_ = false;
};

/// std_msgs/Header. Names of frames without a leading '/'.
struct RosHeader {
  std::int64_t stamp_ns = 0;  ///< 0: not set
  std::string frame;
};
RosHeader take_header(RosFields& fields);
/// Of any message that begins with one.
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

/// A motion between two named frames: of tf, nav_msgs/Odometry or a stamped pose (which names no child).
struct RosMotion {
  RosHeader header;
  std::string child;
  SE3 parent_from_child;
  bool valid = true;  ///< false where its rotation is no quaternion of length 1 or its place is not finite
};
/// Motions that are not valid are kept, for tf2 ignores them, too. The other two functions refuse them (std::invalid_argument).
std::vector<RosMotion> parse_tf(std::string_view message, BagEncoding encoding);
RosMotion parse_odometry(std::string_view message, BagEncoding encoding);
RosMotion parse_pose(std::string_view message, BagEncoding encoding);

/// sensor_msgs/NavSatFix.
struct RosFix {
  RosHeader header;
  bool valid = false;  ///< the receiver had one
  double latitude_deg = 0, longitude_deg = 0;
};
RosFix parse_fix(std::string_view message, BagEncoding encoding);

}  // namespace dvi::bags
