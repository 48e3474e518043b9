#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/bags/ros_cloud.h"

namespace dvi::bags {
namespace {

constexpr std::uint8_t kFloat32 = 7, kFloat64 = 8;  // types of sensor_msgs/PointField

void require_points(std::size_t points, const std::vector<bool>& removed) {
  if (points != removed.size())
    throw std::invalid_argument(fmt::format("it has {} points instead of {}", points, removed.size()));
}

template <class T>
void write_nan(char* at, bool swap) {
  constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
  std::memcpy(at, &kNan, sizeof(T));
  if (swap) std::reverse(at, at + sizeof(T));
}

// Makes the coordinates of points NaN, and the cloud one that is not dense.
std::string blank_points(std::string message, const RosCloudTable& table, const std::vector<bool>& removed) {
  const std::size_t data_at = table.row_step_at + 2 * sizeof(std::uint32_t), dense_at = data_at + table.data.size();
  for (const char* axis : {"x", "y", "z"}) {
    const RosPointField& field = table.columns.at(axis);
    if (field.type != kFloat32 && field.type != kFloat64)
      throw std::invalid_argument("it has several rows of points, and their coordinates are integers, which cannot be NaN");
    for (std::size_t i = 0; i < removed.size(); ++i) {
      if (!removed[i]) continue;
      const std::size_t point = i / table.width * table.row_step + i % table.width * table.step;
      char* const at = message.data() + data_at + point + field.offset;
      field.type == kFloat32 ? write_nan<float>(at, table.swap) : write_nan<double>(at, table.swap);
    }
  }
  if (dense_at >= message.size()) throw std::invalid_argument("it is truncated");
  message[dense_at] = 0;
  return message;
}

std::string drop_points(std::string_view message, const RosCloudTable& table, const std::vector<bool>& removed,
                        bool is_big_endian) {
  std::string kept;
  for (std::size_t i = 0; i < removed.size(); ++i)
    if (!removed[i]) kept += table.data.substr(i * table.step, table.step);
  const std::string points = to_field(static_cast<std::uint32_t>(kept.size() / table.step), is_big_endian),
                    bytes = to_field(static_cast<std::uint32_t>(kept.size()), is_big_endian);
  const std::size_t fields_at = table.width_at + sizeof(std::uint32_t),
                    data_end = table.row_step_at + 2 * sizeof(std::uint32_t) + table.data.size();
  return fmt::format("{}{}{}{}{}{}{}", message.substr(0, table.width_at), points,
                     message.substr(fields_at, table.row_step_at - fields_at), bytes, bytes, kept, message.substr(data_end));
}

}  // namespace

std::string remove_cloud_points(std::string_view message, BagEncoding encoding, const std::vector<bool>& removed) {
  const RosCloudTable table = read_cloud_table(message, encoding);
  require_points(table.height * table.width, removed);
  if (std::find(removed.begin(), removed.end(), true) == removed.end()) return std::string(message);
  if (table.height > 1) return blank_points(std::string(message), table, removed);
  return drop_points(message, table, removed, RosFields(message, encoding).is_big_endian());
}

std::string remove_livox_points(std::string_view message, BagEncoding encoding, const std::vector<bool>& removed) {
  RosFields fields(message, encoding);
  take_header(fields);
  fields.number<std::uint64_t>();  // time base
  fields.number<std::uint32_t>();
  const std::size_t count_at = fields.position() - sizeof(std::uint32_t);
  for (int i = 0; i < 1 + 3; ++i) fields.number<std::uint8_t>();
  const std::size_t between_at = fields.position() - 4;
  const std::uint32_t points = fields.length(kLivoxPointBytes);
  require_points(points, removed);
  std::string kept;
  std::size_t end = fields.position();
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < points; ++i) {
    const std::size_t size = end;
    fields.number<std::uint32_t>();
    const std::size_t begin = fields.position() - sizeof(std::uint32_t);  // after the padding of CDR
    for (int axis = 0; axis < 3; ++axis) fields.number<float>();
    for (int k = 0; k < 3; ++k) fields.number<std::uint8_t>();
    end = fields.position();
    if (removed[i]) continue;
    if (left++ > 0) kept += message.substr(size, begin - size);
    kept += message.substr(begin, end - begin);
  }
  const std::string count = to_field(left, fields.is_big_endian());
  return fmt::format("{}{}{}{}{}{}", message.substr(0, count_at), count, message.substr(between_at, 4), count, kept,
                     message.substr(end));
}

}  // namespace dvi::bags
