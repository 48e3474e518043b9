#include "bag.h"

// The first byte chooses the message and its encoding.
void dvi::fuzz::parse(const fs::path& /*folder*/, const std::string& bytes) {
  if (bytes.empty()) return;
  const bags::BagEncoding encoding = (bytes[0] & 8) != 0 ? bags::BagEncoding::ros1 : bags::BagEncoding::cdr;
  const std::string_view message = std::string_view(bytes).substr(1);
  try {
    switch (bytes[0] & 7) {
      case 0:
        to_bgr(bags::parse_image(message, encoding));
        break;
      case 1:
        bags::parse_image_file(message, encoding);
        break;
      case 2:
        bags::parse_camera_info(message, encoding);
        break;
      case 3:
        bags::parse_tf(message, encoding);
        break;
      case 4:
        bags::parse_odometry(message, encoding);
        break;
      case 5: {
        const bags::RosCloud cloud = bags::parse_cloud(message, encoding);
        for (const Eigen::Vector3f& point : cloud.points) require(point.allFinite(), "points are finite");
        require(cloud.times.empty() || cloud.times.size() == cloud.points.size(), "each point has a time");
        break;
      }
      case 6: {
        const bags::RosFix fix = bags::parse_fix(message, encoding);
        require(!fix.valid || std::abs(fix.latitude_deg) < 90, "places are on Earth");
        break;
      }
      default:
        bags::unpack_message(std::string(message));
        bags::parse_livox(message, encoding);
    }
  } catch (const std::invalid_argument&) {  // the reader of bags names the message
  }
}
