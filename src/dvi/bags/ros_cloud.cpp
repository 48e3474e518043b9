#include "dvi/bags/ros_cloud.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/media/point_number.h"
#include "dvi/media/point_times.h"

namespace dvi::bags {
namespace {

std::size_t count_bytes(std::uint8_t type) {
  constexpr std::size_t kBytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
  return type < std::size(kBytes) ? kBytes[type] : 0;
}

double load_field(const RosPointField& field, const char* point, bool swap) {
  const char* at = point + field.offset;
  switch (field.type) {
    case 1:
      return media::load_number<std::int8_t>(at, swap);
    case 2:
      return media::load_number<std::uint8_t>(at, swap);
    case 3:
      return media::load_number<std::int16_t>(at, swap);
    case 4:
      return media::load_number<std::uint16_t>(at, swap);
    case 5:
      return media::load_number<std::int32_t>(at, swap);
    case 6:
      return media::load_number<std::uint32_t>(at, swap);
    case 7:
      return media::load_number<float>(at, swap);
    default:
      return media::load_number<double>(at, swap);
  }
}

std::optional<RosPointField> find_first(const RosPointFields& fields, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto field = fields.find(name); field != fields.end()) return field->second;
  return std::nullopt;
}

}  // namespace

RosCloudTable read_cloud_table(std::string_view message, BagEncoding encoding) {
  constexpr std::size_t kMinFieldBytes = 4 + 4 + 1 + 4;
  RosFields fields(message, encoding);
  RosCloudTable table{.header = take_header(fields)};
  table.height = fields.number<std::uint32_t>();
  table.width = fields.number<std::uint32_t>();
  table.width_at = fields.position() - sizeof(std::uint32_t);
  for (std::uint32_t left = fields.length(kMinFieldBytes); left > 0; --left) {
    const std::string name = fields.text();
    RosPointField field;
    field.offset = fields.number<std::uint32_t>();
    field.type = fields.number<std::uint8_t>();
    fields.number<std::uint32_t>();  // count
    table.columns[name] = field;
  }
  table.swap = fields.number<std::uint8_t>() != 0;
  table.step = fields.number<std::uint32_t>();
  table.row_step = fields.number<std::uint32_t>();
  table.row_step_at = fields.position() - sizeof(std::uint32_t);
  if (table.height == 1) table.row_step = table.width * table.step;  // some writers set it to 0
  table.data = fields.bytes();
  for (const char* axis : {"x", "y", "z"})
    if (!table.columns.contains(axis)) throw std::invalid_argument("its points have no fields x, y and z");
  for (const auto& [name, field] : table.columns)
    if (const std::size_t bytes = count_bytes(field.type);
        bytes == 0 || field.offset > table.step || bytes > table.step - field.offset)
      throw std::invalid_argument(fmt::format("its field '{}' lies outside of a point of {} bytes", name, table.step));
  const std::uint64_t row = table.width * table.step;
  if (row > 0 && table.height > 0 && (table.row_step < row || table.data.size() < (table.height - 1) * table.row_step + row))
    throw std::invalid_argument(fmt::format("{} bytes are not {} times {} points of {} bytes", table.data.size(), table.height,
                                            table.width, table.step));
  return table;
}

RosCloud parse_cloud(std::string_view message, BagEncoding encoding) {
  const RosCloudTable table = read_cloud_table(message, encoding);
  const RosPointFields& columns = table.columns;
  const bool swap = table.swap;
  RosCloud cloud{.header = table.header};
  const auto x = find_first(columns, {"x"}), y = find_first(columns, {"y"}), z = find_first(columns, {"z"});
  const auto intensity = find_first(columns, {"intensity", "i", "reflectivity", "signal"});
  const auto ring = find_first(columns, {"ring", "channel", "line", "laser_id"});
  std::vector<std::string> names;
  for (const auto& [name, field] : columns) names.push_back(name);
  const std::optional<std::size_t> time_field = media::find_time_field(names);
  std::optional<RosPointField> time;
  if (time_field) cloud.time_field = names[*time_field], time = columns.at(cloud.time_field);
  for (std::uint64_t v = 0; v < table.height; ++v)
    for (std::uint64_t u = 0; u < table.width; ++u) {
      const char* point = table.data.data() + v * table.row_step + u * table.step;
      const std::size_t number = cloud.message_points++;
      const Eigen::Vector3f p(static_cast<float>(load_field(*x, point, swap)), static_cast<float>(load_field(*y, point, swap)),
                              static_cast<float>(load_field(*z, point, swap)));
      if (!p.allFinite() || p.isZero()) continue;  // no return
      const double when = time ? load_field(*time, point, swap) : 0;
      if (!std::isfinite(when)) continue;
      cloud.points.push_back(p);
      cloud.index.push_back(static_cast<std::uint32_t>(number));
      cloud.intensity.push_back(intensity ? static_cast<float>(load_field(*intensity, point, swap)) : 0.0F);
      if (ring) cloud.ring.push_back(media::to_ring(load_field(*ring, point, swap)));
      if (time) cloud.times.push_back(when);
    }
  return cloud;
}

RosCloud parse_livox(std::string_view message, BagEncoding encoding) {
  RosFields fields(message, encoding);
  RosCloud cloud{.header = take_header(fields), .time_field = "offset_time"};
  fields.number<std::uint64_t>();                                 // time base: the time of the header, by the sensor's clock
  fields.number<std::uint32_t>();                                 // number of points, which the list states as well
  for (int i = 0; i < 1 + 3; ++i) fields.number<std::uint8_t>();  // number of the sensor, reserved bytes
  for (std::uint32_t left = fields.length(kLivoxPointBytes); left > 0; --left) {
    const double offset_time = fields.number<std::uint32_t>();
    Eigen::Vector3f p;
    for (float& coordinate : p) coordinate = fields.number<float>();
    const auto reflectivity = fields.number<std::uint8_t>();
    fields.number<std::uint8_t>();  // tag: the number and confidence of the return
    const auto line = fields.number<std::uint8_t>();
    const std::size_t number = cloud.message_points++;
    if (!p.allFinite() || p.isZero()) continue;  // no return
    cloud.points.push_back(p);
    cloud.index.push_back(static_cast<std::uint32_t>(number));
    cloud.intensity.push_back(reflectivity);
    cloud.ring.push_back(line);
    cloud.times.push_back(offset_time);
  }
  return cloud;
}

}  // namespace dvi::bags
