#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/bags/ros_message.h"

namespace dvi::bags {

/// The finite points of a scan message.
struct RosCloud {
  RosHeader header;
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;     ///< one per point; 0 if the message has none
  std::vector<std::uint16_t> ring;  ///< one per point, or empty
  std::vector<double> times;        ///< one per point, in the unit and from the origin of the message; or empty
  std::string time_field;           ///< the name of the field with the times
};

/// Parses a sensor_msgs/PointCloud2 with any fields. Throws std::invalid_argument if it is malformed.
RosCloud parse_cloud(std::string_view message, BagEncoding encoding);

/// Parses a CustomMsg of Livox's drivers livox_ros_driver, livox_ros_driver2 and livox_interfaces. Throws the same errors.
RosCloud parse_livox(std::string_view message, BagEncoding encoding);

}  // namespace dvi::bags
