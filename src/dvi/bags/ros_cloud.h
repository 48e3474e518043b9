#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/bags/ros_message.h"

namespace dvi::bags {

/// The returns of a scan message: its points that are finite and not at the origin.
struct RosCloud {
  RosHeader header;
  std::vector<Eigen::Vector3f> points = {};
  std::vector<float> intensity = {};      ///< one per point; 0 if the message has none
  std::vector<std::uint16_t> ring = {};   ///< one per point, or empty
  std::vector<double> times = {};         ///< one per point, in the unit and from the origin of the message; or empty
  std::string time_field = {};            ///< the name of the field with the times
  std::size_t message_points = 0;         ///< all points of the message
  std::vector<std::uint32_t> index = {};  ///< one per point: its index in the message
};

/// sensor_msgs/PointField: the position and type of a number of a point.
struct RosPointField {
  std::uint32_t offset = 0;
  std::uint8_t type = 0;
};
using RosPointFields = std::map<std::string, RosPointField>;

/// The table of a sensor_msgs/PointCloud2: rows of points in the bytes of a message, and the positions of its sizes there.
struct RosCloudTable {
  RosHeader header;
  RosPointFields columns = {};  ///< by name; x, y, and z exist
  std::uint64_t height = 0, width = 0, step = 0, row_step = 0;
  bool swap = false;           ///< whether its numbers are big-endian
  std::string_view data = {};  ///< of the message
  std::size_t width_at = 0, row_step_at = 0;
};

/// Reads the table of a sensor_msgs/PointCloud2. Throws std::invalid_argument if it is malformed.
RosCloudTable read_cloud_table(std::string_view message, BagEncoding encoding);

/// Parses a sensor_msgs/PointCloud2 with any fields. Throws std::invalid_argument if it is malformed.
RosCloud parse_cloud(std::string_view message, BagEncoding encoding);

/// The bytes of a point in a CustomMsg of Livox: its time, coordinates, reflectivity, tag, and line.
inline constexpr std::size_t kLivoxPointBytes = 4 + 3 * sizeof(float) + 3;

/// Parses a CustomMsg of Livox's drivers livox_ros_driver, livox_ros_driver2 and livox_interfaces. Throws the same errors.
RosCloud parse_livox(std::string_view message, BagEncoding encoding);

/// Removes points from a sensor_msgs/PointCloud2. `removed` has one item per point of the message. A cloud of one row gets
/// shorter; one of several rows keeps its size, and the coordinates of removed points become NaN. All other bytes are kept.
/// Throws std::invalid_argument if the message is malformed or has another number of points, or if it has several rows of
/// points whose coordinates cannot be NaN.
std::string remove_cloud_points(std::string_view message, BagEncoding encoding, const std::vector<bool>& removed);

/// Removes points from a CustomMsg of Livox in the same way. Throws the same errors.
std::string remove_livox_points(std::string_view message, BagEncoding encoding, const std::vector<bool>& removed);

}  // namespace dvi::bags
