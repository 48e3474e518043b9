#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/geometry/se3.h"
#include "dvi/io/bag.h"

namespace dvi::io {

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
/// Of any message that begins with one.
RosHeader read_header(std::string_view message, BagEncoding encoding);

/// sensor_msgs/Image before its pixels are converted.
struct RosImage {
  RosHeader header;
  std::uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  std::string_view data;  ///< of the message
};
RosImage parse_image(std::string_view message, BagEncoding encoding);
/// Its colours. Depth images are none. std::invalid_argument where its encoding is not known or data are missing.
cv::Mat3b to_bgr(const RosImage& image);

/// Depth in millimetres, 0 where there is none, of a sensor_msgs/Image of 16UC1 (millimetres) or 32FC1 (metres).
/// std::invalid_argument as to_bgr().
cv::Mat1w to_depth(const RosImage& image);
bool is_depth(const RosImage& image);

/// The file, PNG or JPEG, in a sensor_msgs/CompressedImage.
std::string compressed_image(std::string_view message, BagEncoding encoding);

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
};
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

/// The finite points of a sensor_msgs/PointCloud2.
struct RosCloud {
  RosHeader header;
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;     ///< one a point; 0 where the message has none
  std::vector<std::uint16_t> ring;  ///< one a point, or empty
  std::vector<double> after_stamp;  ///< one a point, seconds after the message's stamp; or empty
};
RosCloud parse_cloud(std::string_view message, BagEncoding encoding);

}  // namespace dvi::io
