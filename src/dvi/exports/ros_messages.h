#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dvi/exports/map_cloud.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

/// ROS 2 messages as bytes (CDR, little endian). All are in the frame "world", except images and their camera, which are in the
/// frame of that camera (`frame_id`).
namespace dvi::exports::ros {

/// A message type and its definition, including the definitions of its parts (ros2msg).
struct MessageType {
  std::string name, definition;
};

MessageType compressed_image_type();  ///< sensor_msgs/msg/CompressedImage
MessageType camera_info_type();       ///< sensor_msgs/msg/CameraInfo
MessageType point_cloud_type();       ///< sensor_msgs/msg/PointCloud2
MessageType path_type();              ///< nav_msgs/msg/Path
MessageType transform_type();         ///< tf2_msgs/msg/TFMessage

struct StampedMotion {
  std::int64_t time_ns = 0;
  SE3 world_from_camera;
};

/// The header of a message of a camera.
struct Header {
  std::int64_t time_ns = 0;
  std::string frame_id;
};

/// Makes a sensor_msgs/msg/CompressedImage. `format` is png or jpeg; `bytes` is the file.
std::string compressed_image(const Header& header, const std::string& format, const std::string& bytes);
std::string camera_info(const Header& header, const Camera& camera);
/// Makes a point cloud with the fields x, y, z, rgb.
std::string point_cloud(std::int64_t time_ns, const std::vector<CloudPoint>& cloud);
std::string path(const std::vector<StampedMotion>& poses);
std::string transform(const StampedMotion& pose, const std::string& frame_id);

}  // namespace dvi::exports::ros
