#include "dvi/bags/ros_message.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/bags/bag_bytes.h"
#include "dvi/geometry/plausible.h"

namespace dvi::bags {
namespace {

std::string without_slash(std::string frame) { return frame.starts_with('/') ? frame.substr(1) : frame; }

// Reads a motion; returns nothing if it is not a rigid motion.
std::optional<SE3> take_any_motion(RosFields& fields) {
  const auto t = fields.numbers<3>();
  const auto q = fields.numbers<4>();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (!(std::abs(rotation.norm() - 1) <= kMaxRotationError) || !std::isfinite(t[0] + t[1] + t[2])) return {};
  return SE3{rotation.normalized().toRotationMatrix(), {t[0], t[1], t[2]}};
}

SE3 take_motion(RosFields& fields) {
  const std::optional<SE3> motion = take_any_motion(fields);
  if (!motion) throw std::invalid_argument("its rotation is not a quaternion of length 1, or its translation is not finite");
  return *motion;
}

}  // namespace

RosFields::RosFields(std::string_view bytes, BagEncoding encoding) : message_(bytes.data()), all_(bytes), encoding_(encoding) {
  if (encoding == BagEncoding::ros1) return;
  if (encoding != BagEncoding::cdr) throw std::invalid_argument("its encoding is neither CDR nor that of ROS 1");
  constexpr std::size_t kHeadBytes = 4;
  if (bytes.size() < kHeadBytes) throw std::invalid_argument("it is too short");
  if (bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1))
    throw std::invalid_argument(fmt::format("its representation {:02x} {:02x} is not plain CDR",
                                            static_cast<unsigned char>(bytes[0]), static_cast<unsigned char>(bytes[1])));
  swap_ = bytes[1] == 0;
  all_.remove_prefix(kHeadBytes);
}

std::string_view RosFields::take(std::size_t count, std::size_t alignment) {
  if (encoding_ == BagEncoding::cdr) at_ += (alignment - at_ % alignment) % alignment;
  if (at_ > all_.size() || count > all_.size() - at_) throw std::invalid_argument("it is truncated");
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
  if (count > (all_.size() - std::min(at_, all_.size())) / item_bytes) throw std::invalid_argument("it is truncated");
  return count;
}

std::vector<double> RosFields::list() {
  std::vector<double> out(length(sizeof(double)));
  for (double& value : out) value = number<double>();
  return out;
}

std::string to_field(std::uint32_t value, bool is_big_endian) {
  std::string out = to_bytes(value);
  if (is_big_endian) std::reverse(out.begin(), out.end());
  return out;
}

RosHeader take_header(RosFields& fields) {
  if (fields.encoding() == BagEncoding::ros1) fields.number<std::uint32_t>();  // sequence
  RosHeader header;
  const std::int64_t seconds = fields.number<std::int32_t>(), nanoseconds = fields.number<std::uint32_t>();
  header.stamp_ns = seconds * 1'000'000'000 + nanoseconds;
  header.frame = without_slash(fields.text());
  return header;
}

RosHeader read_header(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  return take_header(fields);
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
  constexpr std::size_t kMinMotionBytes = 8 + 4 + 4 + 7 * sizeof(double);
  RosFields fields(message, encoding);
  std::vector<RosMotion> out;
  for (std::uint32_t left = fields.length(kMinMotionBytes); left > 0; --left) {
    RosMotion motion{.header = take_header(fields), .child = {}, .parent_from_child = {}};
    motion.child = without_slash(fields.text());
    const std::optional<SE3> taken = take_any_motion(fields);
    motion.valid = taken.has_value();
    motion.parent_from_child = taken.value_or(SE3());
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
  fields.number<std::uint16_t>();                          // the satellite systems
  fix.latitude_deg = fields.number<double>(), fix.longitude_deg = fields.number<double>();
  fix.valid = has_fix && std::abs(fix.latitude_deg) < 90 && std::abs(fix.longitude_deg) <= 360;  // false for NaN
  return fix;
}

}  // namespace dvi::bags
