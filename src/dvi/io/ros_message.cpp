#include "dvi/io/ros_message.h"

#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dvi/io/image_file.h"
#include "dvi/io/plausible.h"

namespace dvi::io {
namespace {

std::string without_slash(std::string frame) { return frame.starts_with('/') ? frame.substr(1) : frame; }

RosHeader take_header(RosFields& fields) {
  if (fields.encoding() == BagEncoding::ros1) fields.number<std::uint32_t>();  // sequence
  RosHeader header;
  const std::int64_t seconds = fields.number<std::int32_t>(), nanoseconds = fields.number<std::uint32_t>();
  header.stamp_ns = seconds * 1'000'000'000 + nanoseconds;
  header.frame = without_slash(fields.text());
  return header;
}

SE3 take_motion(RosFields& fields) {
  const auto t = fields.numbers<3>();
  const auto q = fields.numbers<4>();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (!(std::abs(rotation.norm() - 1) <= kPrintedRotation) || !std::isfinite(t[0] + t[1] + t[2]))
    throw std::invalid_argument(
        fmt::format("its rotation is a quaternion of length {:.3g}, not 1, or its place is not finite", rotation.norm()));
  return {rotation.normalized().toRotationMatrix(), {t[0], t[1], t[2]}};
}

// OpenCV names a Bayer pattern by the second row's second and third pixel, ROS by the first ones.
const std::map<std::string, std::pair<int, std::optional<int>>>& image_encodings() {
  static const std::map<std::string, std::pair<int, std::optional<int>>> encodings = {
      {"bgr8", {CV_8UC3, std::nullopt}},
      {"8UC3", {CV_8UC3, std::nullopt}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"8UC4", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"mono8", {CV_8UC1, cv::COLOR_GRAY2BGR}},
      {"8UC1", {CV_8UC1, cv::COLOR_GRAY2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
  };
  return encodings;
}

// sensor_msgs/PointField: what a number of a point is, and where.
struct RosPointField {
  std::uint32_t offset = 0;
  std::uint8_t type = 0;
};

std::size_t bytes_of_type(std::uint8_t type) {
  constexpr std::size_t kBytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return type < std::size(kBytes) ? kBytes[type] : 0;
}

template <class T>
double loaded(const char* at, bool swap) {
  char raw[sizeof(T)];
  std::memcpy(raw, at, sizeof(T));
  if (swap) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return static_cast<double>(value);
}

double load_field(const RosPointField& field, const char* point, bool swap) {
  const char* at = point + field.offset;
  switch (field.type) {
    case 1:
      return loaded<std::int8_t>(at, swap);
    case 2:
      return loaded<std::uint8_t>(at, swap);
    case 3:
      return loaded<std::int16_t>(at, swap);
    case 4:
      return loaded<std::uint16_t>(at, swap);
    case 5:
      return loaded<std::int32_t>(at, swap);
    case 6:
      return loaded<std::uint32_t>(at, swap);
    case 7:
      return loaded<float>(at, swap);
    default:
      return loaded<double>(at, swap);
  }
}

using RosPointFields = std::map<std::string, RosPointField>;

std::optional<RosPointField> first_of(const RosPointFields& fields, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto field = fields.find(name); field != fields.end()) return field->second;
  return std::nullopt;
}

// Drivers count a point's time in whole nanoseconds or in seconds, after the stamp or since 1970.
double seconds_after(double value, bool whole, std::int64_t stamp_ns) {
  constexpr double kSinceEpoch = 1e8, kNanosecondsSinceEpoch = 1e17;
  if (whole) return 1e-9 * (value > kNanosecondsSinceEpoch ? value - static_cast<double>(stamp_ns) : value);
  if (value > kNanosecondsSinceEpoch) return 1e-9 * (value - static_cast<double>(stamp_ns));
  return value > kSinceEpoch ? value - 1e-9 * static_cast<double>(stamp_ns) : value;
}

}  // namespace

RosFields::RosFields(std::string_view bytes, BagEncoding encoding) : all_(bytes), encoding_(encoding) {
  if (encoding == BagEncoding::ros1) return;
  if (encoding != BagEncoding::cdr) throw std::invalid_argument("its encoding is neither CDR nor that of ROS 1");
  constexpr std::size_t kHead = 4;
  if (bytes.size() < kHead) throw std::invalid_argument("it is too short");
  if (bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1))
    throw std::invalid_argument(fmt::format("its representation {:02x} {:02x} is not plain CDR",
                                            static_cast<unsigned char>(bytes[0]), static_cast<unsigned char>(bytes[1])));
  swap_ = bytes[1] == 0;
  all_.remove_prefix(kHead);
}

std::string_view RosFields::take(std::size_t count, std::size_t alignment) {
  if (encoding_ == BagEncoding::cdr) at_ += (alignment - at_ % alignment) % alignment;
  if (at_ > all_.size() || count > all_.size() - at_) throw std::invalid_argument("it ends too early");
  at_ += count;
  return all_.substr(at_ - count, count);
}

std::string RosFields::text() {
  std::string out(bytes());
  if (encoding_ == BagEncoding::cdr && out.ends_with('\0')) out.pop_back();
  return out;
}

std::string_view RosFields::bytes() {
  const auto count = number<std::uint32_t>();
  return take(count, 1);
}

std::uint32_t RosFields::length(std::size_t item_bytes) {
  const auto count = number<std::uint32_t>();
  if (count > (all_.size() - std::min(at_, all_.size())) / item_bytes) throw std::invalid_argument("it ends too early");
  return count;
}

std::vector<double> RosFields::list() {
  std::vector<double> out(length(sizeof(double)));
  for (double& value : out) value = number<double>();
  return out;
}

RosHeader read_header(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  return take_header(fields);
}

RosImage parse_image(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosImage image{.header = take_header(fields), .encoding = {}, .data = {}};
  image.height = fields.number<std::uint32_t>();
  image.width = fields.number<std::uint32_t>();
  image.encoding = fields.text();
  fields.number<std::uint8_t>();  // byte order, of wider pixels
  image.step = fields.number<std::uint32_t>();
  image.data = fields.bytes();
  return image;
}

namespace {

// The pixels of the message, where they lie.
cv::Mat pixels(const RosImage& image, int type) {
  const std::uint64_t row = std::uint64_t{image.width} * CV_ELEM_SIZE(type);
  if (image.width == 0 || image.height == 0 ||
      std::uint64_t{image.width} * image.height > static_cast<std::uint64_t>(kMostPixels))
    throw std::invalid_argument(fmt::format("{}x{} pixels are none that dvi reads", image.width, image.height));
  if (image.step < row || image.data.size() < (image.height - 1) * std::uint64_t{image.step} + row)
    throw std::invalid_argument(fmt::format("{} bytes in rows of {} are not {}x{} pixels of {}", image.data.size(), image.step,
                                            image.width, image.height, image.encoding));
  return {static_cast<int>(image.height), static_cast<int>(image.width), type, const_cast<char*>(image.data.data()),
          image.step};
}

}  // namespace

bool is_depth(const RosImage& image) {
  return image.encoding == "16UC1" || image.encoding == "mono16" || image.encoding == "32FC1";
}

cv::Mat1w to_depth(const RosImage& image) {
  if (!is_depth(image))
    throw std::invalid_argument(fmt::format("its encoding '{}' is no depth that dvi reads: 16UC1 or 32FC1", image.encoding));
  const bool metres = image.encoding == "32FC1";
  const cv::Mat aligned = pixels(image, metres ? CV_8UC4 : CV_8UC2).clone();  // in the message they lie at any address
  const cv::Mat raw(aligned.size(), metres ? CV_32FC1 : CV_16UC1, aligned.data);
  cv::Mat1w out(raw.rows, raw.cols, ushort{0});
  constexpr float kMost = 65.5F;
  for (int y = 0; y < raw.rows; ++y)
    for (int x = 0; x < raw.cols; ++x) {
      if (!metres) {
        out(y, x) = raw.at<ushort>(y, x);
      } else if (const float z = raw.at<float>(y, x); z > 0 && z < kMost) {  // not NaN: there, nothing was measured
        out(y, x) = static_cast<ushort>(std::lround(1000 * z));
      }
    }
  return out;
}

cv::Mat3b to_bgr(const RosImage& image) {
  const auto encoding = image_encodings().find(image.encoding);
  if (encoding == image_encodings().end())
    throw std::invalid_argument(fmt::format("its encoding '{}' is no 8-bit colour or grey that dvi reads", image.encoding));
  const auto& [type, conversion] = encoding->second;
  const cv::Mat raw = pixels(image, type);
  cv::Mat out;
  if (conversion)
    cv::cvtColor(raw, out, *conversion);
  else
    out = raw.clone();
  return out;
}

std::string compressed_image(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  take_header(fields);
  fields.text();  // the format, which the file itself tells
  return std::string(fields.bytes());
}

RosCameraInfo parse_camera_info(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosCameraInfo info{.header = take_header(fields), .model = {}, .D = {}};
  info.height = static_cast<int>(std::min<std::uint32_t>(fields.number<std::uint32_t>(), 1U << 20));
  info.width = static_cast<int>(std::min<std::uint32_t>(fields.number<std::uint32_t>(), 1U << 20));
  info.model = fields.text();
  info.D = fields.list();
  info.K = fields.numbers<9>();
  fields.numbers<9>();  // R, of the rectification
  info.P = fields.numbers<12>();
  return info;
}

std::vector<RosMotion> parse_tf(std::string_view message, BagEncoding encoding) {
  constexpr std::size_t kLeast = 8 + 4 + 4 + 7 * sizeof(double);
  RosFields fields(message, encoding);
  std::vector<RosMotion> out;
  for (std::uint32_t left = fields.length(kLeast); left > 0; --left) {
    RosMotion motion{.header = take_header(fields), .child = {}, .parent_from_child = {}};
    motion.child = without_slash(fields.text());
    motion.parent_from_child = take_motion(fields);
    out.push_back(std::move(motion));
  }
  return out;
}

RosMotion parse_odometry(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosMotion motion{.header = take_header(fields), .child = {}, .parent_from_child = {}};
  motion.child = without_slash(fields.text());
  motion.parent_from_child = take_motion(fields);
  return motion;
}

RosMotion parse_pose(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosMotion motion{.header = take_header(fields), .child = {}, .parent_from_child = {}};
  motion.parent_from_child = take_motion(fields);
  return motion;
}

RosFix parse_fix(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosFix fix{.header = take_header(fields)};
  const bool has_fix = fields.number<std::int8_t>() >= 0;  // NavSatStatus.STATUS_NO_FIX is -1
  fields.number<std::uint16_t>();                          // of which satellites
  fix.latitude_deg = fields.number<double>(), fix.longitude_deg = fields.number<double>();
  fix.valid = has_fix && std::abs(fix.latitude_deg) < 90 && std::abs(fix.longitude_deg) <= 360;  // NaN is not
  return fix;
}

RosCloud parse_cloud(std::string_view message, BagEncoding encoding) {
  constexpr std::size_t kLeastField = 4 + 4 + 1 + 4;
  RosFields fields(message, encoding);
  RosCloud cloud{.header = take_header(fields), .points = {}, .intensity = {}, .ring = {}, .after_stamp = {}};
  const std::uint64_t height = fields.number<std::uint32_t>(), width = fields.number<std::uint32_t>();
  RosPointFields columns;
  for (std::uint32_t left = fields.length(kLeastField); left > 0; --left) {
    const std::string name = fields.text();
    RosPointField field;
    field.offset = fields.number<std::uint32_t>();
    field.type = fields.number<std::uint8_t>();
    fields.number<std::uint32_t>();  // count
    columns[name] = field;
  }
  const bool swap = fields.number<std::uint8_t>() != 0;
  const std::uint64_t step = fields.number<std::uint32_t>(), row_step = fields.number<std::uint32_t>();
  const std::string_view data = fields.bytes();
  const auto x = first_of(columns, {"x"}), y = first_of(columns, {"y"}), z = first_of(columns, {"z"});
  if (!x || !y || !z) throw std::invalid_argument("its points have no fields x, y and z");
  for (const auto& [name, field] : columns)
    if (const std::size_t bytes = bytes_of_type(field.type); bytes == 0 || field.offset > step || bytes > step - field.offset)
      throw std::invalid_argument(fmt::format("its field '{}' lies outside of a point of {} bytes", name, step));
  if (width > 0 && height > 0 && (row_step < width * step || data.size() < (height - 1) * row_step + width * step))
    throw std::invalid_argument(
        fmt::format("{} bytes are not {} times {} points of {} bytes", data.size(), height, width, step));
  const auto intensity = first_of(columns, {"intensity", "i", "reflectivity", "signal"});
  const auto ring = first_of(columns, {"ring", "channel", "line", "laser_id"});
  const auto time = first_of(columns, {"t", "time", "timestamp", "offset_time", "time_stamp", "timeOffset"});
  const bool whole = time && time->type <= 6;
  for (std::uint64_t v = 0; v < height; ++v)
    for (std::uint64_t u = 0; u < width; ++u) {
      const char* point = data.data() + v * row_step + u * step;
      const Eigen::Vector3f p(static_cast<float>(load_field(*x, point, swap)), static_cast<float>(load_field(*y, point, swap)),
                              static_cast<float>(load_field(*z, point, swap)));
      if (!p.allFinite() || p.isZero()) continue;  // no return
      const double after = time ? seconds_after(load_field(*time, point, swap), whole, cloud.header.stamp_ns) : 0;
      if (!std::isfinite(after)) continue;
      cloud.points.push_back(p);
      cloud.intensity.push_back(intensity ? static_cast<float>(load_field(*intensity, point, swap)) : 0.0F);
      if (ring) cloud.ring.push_back(static_cast<std::uint16_t>(std::clamp(load_field(*ring, point, swap), 0.0, 65535.0)));
      if (time) cloud.after_stamp.push_back(after);
    }
  return cloud;
}

}  // namespace dvi::io
