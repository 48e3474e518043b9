#include "dvi/exports/ros_messages.h"

#include <array>
#include <initializer_list>

#include "dvi/core/error.h"

namespace dvi::exports::ros {
namespace {

/// The fields of a message in order, each aligned to its size relative to the end of the four-byte encapsulation header.
class Cdr {
 public:
  template <class T>
  Cdr& number(T value) {
    while ((bytes_.size() - kHeaderBytes) % sizeof value != 0) bytes_ += '\0';
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Cdr& count(std::size_t items) { return number(static_cast<std::uint32_t>(items)); }
  Cdr& text(const std::string& value) {
    count(value.size() + 1);
    bytes_ += value + '\0';
    return *this;
  }
  Cdr& blob(const std::string& value) {
    count(value.size());
    bytes_ += value;
    return *this;
  }
  template <class Values>
  Cdr& numbers(const Values& values) {
    for (const double value : values) number(value);
    return *this;
  }
  Cdr& header(std::int64_t time_ns, const std::string& frame) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    const std::int64_t ns = ((time_ns % kSecond) + kSecond) % kSecond;
    number(static_cast<std::int32_t>((time_ns - ns) / kSecond)).number(static_cast<std::uint32_t>(ns));
    return text(frame);
  }
  Cdr& motion(const SE3& pose) {
    const Eigen::Quaterniond q(pose.R);
    return numbers(std::array{pose.t.x(), pose.t.y(), pose.t.z(), q.x(), q.y(), q.z(), q.w()});
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr std::size_t kHeaderBytes = 4;
  std::string bytes_{"\0\1\0\0", kHeaderBytes};
};

constexpr const char* kWorld = "world";

const std::string kTime = "int32 sec\nuint32 nanosec\n";
const std::string kHeaderFields = "builtin_interfaces/Time stamp\nstring frame_id\n";
const std::string kThree = "float64 x\nfloat64 y\nfloat64 z\n";
const std::string kFour = kThree + "float64 w\n";

struct Part {
  std::string name, fields;
};

const Part kHeaderPart{"std_msgs/Header", kHeaderFields}, kTimePart{"builtin_interfaces/Time", kTime};

std::string definition(std::string text, const std::vector<Part>& parts) {
  for (const Part& part : parts) text += std::string(80, '=') + "\nMSG: " + part.name + "\n" + part.fields;
  return text;
}

}  // namespace

MessageType compressed_image_type() {
  return {"sensor_msgs/msg/CompressedImage",
          definition("std_msgs/Header header\nstring format\nuint8[] data\n", {kHeaderPart, kTimePart})};
}

MessageType camera_info_type() {
  return {"sensor_msgs/msg/CameraInfo",
          definition("std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
                     "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
                     {kHeaderPart,
                      kTimePart,
                      {"sensor_msgs/RegionOfInterest",
                       "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"}})};
}

MessageType point_cloud_type() {
  return {
      "sensor_msgs/msg/PointCloud2",
      definition(
          "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n"
          "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
          {kHeaderPart, kTimePart, {"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"}})};
}

MessageType path_type() {
  return {"nav_msgs/msg/Path",
          definition("std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
                     {kHeaderPart,
                      kTimePart,
                      {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
                      {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
                      {"geometry_msgs/Point", kThree},
                      {"geometry_msgs/Quaternion", kFour}})};
}

MessageType transform_type() {
  return {"tf2_msgs/msg/TFMessage",
          definition("geometry_msgs/TransformStamped[] transforms\n",
                     {{"geometry_msgs/TransformStamped",
                       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
                      {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
                      {"geometry_msgs/Vector3", kThree},
                      {"geometry_msgs/Quaternion", kFour},
                      kHeaderPart,
                      kTimePart})};
}

std::string compressed_image(const Header& header, const std::string& format, const std::string& bytes) {
  return Cdr().header(header.time_ns, header.frame_id).text(format).blob(bytes).bytes();
}

// The names are those of sensor_msgs/distortion_models; it has none for the unified model and panoramas.
std::string name_distortion(const Camera& c) {
  if (c.model == CameraModel::fisheye) return "equidistant";
  if (c.model != CameraModel::pinhole) return to_string(c.model);
  return c.coefficients().size() > 5 ? "rational_polynomial" : "plumb_bob";
}

// The unified model has its xi before the coefficients.
std::vector<double> list_coefficients(const Camera& c) {
  std::vector<double> out(c.coefficients().begin(), c.coefficients().end());
  if (c.model == CameraModel::unified) out.insert(out.begin(), c.xi);
  return out;
}

std::string camera_info(const Header& header, const Camera& c) {
  Cdr out;
  out.header(header.time_ns, header.frame_id)
      .count(static_cast<std::size_t>(c.height))
      .count(static_cast<std::size_t>(c.width));
  const std::vector<double> D = list_coefficients(c);
  out.text(name_distortion(c)).count(D.size()).numbers(D);
  out.numbers(std::array{c.fx, 0., c.cx, 0., c.fy, c.cy, 0., 0., 1.});
  out.numbers(std::array{1., 0., 0., 0., 1., 0., 0., 0., 1.});
  out.numbers(std::array{c.fx, 0., c.cx, 0., 0., c.fy, c.cy, 0., 0., 0., 1., 0.});
  for (int k = 0; k < 6; ++k) out.count(0);  // no binning and no region
  return out.number(std::uint8_t{0}).bytes();
}

std::string point_cloud(std::int64_t time_ns, const std::vector<CloudPoint>& cloud) {
  constexpr std::uint8_t kFloat32 = 7;
  constexpr std::size_t kPointStepBytes = 16;
  if (cloud.size() > (std::size_t{1} << 32) / kPointStepBytes - 1)
    throw UsageError("--max-points: a message can hold at most 268 million points");
  Cdr out;
  out.header(time_ns, kWorld).count(1).count(cloud.size()).count(4);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "rgb"}) {
    out.text(name).number(offset).number(kFloat32).count(1);
    offset += 4;
  }
  std::string data;
  data.reserve(cloud.size() * kPointStepBytes);
  for (const CloudPoint& p : cloud) {
    data.append(reinterpret_cast<const char*>(p.position.data()), 12);
    data.append(reinterpret_cast<const char*>(p.color.val), 3);  // 0x00RRGGBB, little endian
    data += '\0';
  }
  return out.number(std::uint8_t{0}).count(kPointStepBytes).count(data.size()).blob(data).number(std::uint8_t{1}).bytes();
}

std::string path(const std::vector<StampedMotion>& poses) {
  Cdr out;
  out.header(poses.empty() ? 0 : poses.front().time_ns, kWorld).count(poses.size());
  for (const StampedMotion& pose : poses) out.header(pose.time_ns, kWorld).motion(pose.world_from_camera);
  return out.bytes();
}

std::string transform(const StampedMotion& pose, const std::string& frame_id) {
  return Cdr().count(1).header(pose.time_ns, kWorld).text(frame_id).motion(pose.world_from_camera).bytes();
}

}  // namespace dvi::exports::ros
