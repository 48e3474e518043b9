#include "dvi/media/point_cloud.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/media/point_number.h"
#include "dvi/media/point_table.h"

namespace dvi::media {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBinPointBytes = BinShape().point_bytes();  // in a scan that dvi writes

// Throws InputError if the file's own values contradict the layout of the other files.
void require_shape(const fs::path& path, std::string_view bytes, const BinLayout& layout) {
  if (layout.stated) return;
  const std::optional<BinShape> shape = infer_bin_shape(bytes);
  if (shape && *shape != layout.shape())
    throw InputError(path, fmt::format("looks like {}, but other scans have {}", to_text(*shape), to_text(layout.shape())),
                     "write all scans with the same columns");
}

PointCloud read_bin(const fs::path& path, const BinLayout& layout) {
  check_size(path, layout.shape().point_bytes());
  const std::string bytes = read_file(path);
  require_shape(path, bytes, layout);
  const auto place = [&](const char* name) -> std::optional<std::size_t> {
    const auto column = std::find(layout.columns.begin(), layout.columns.end(), name);
    if (column == layout.columns.end()) return std::nullopt;
    return static_cast<std::size_t>(column - layout.columns.begin()) * layout.scalar_bytes;
  };
  const auto x = place("x"), y = place("y"), z = place("z"), intensity = place("intensity"), ring = place("ring"),
             t = place("t");
  const std::size_t step = layout.shape().point_bytes();
  PointCloud cloud;
  cloud.points.reserve(bytes.size() / step);
  cloud.intensity.reserve(bytes.size() / step);
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    const auto value = [&](std::size_t offset) { return load_scalar(bytes.data() + at + offset, layout.scalar_bytes); };
    cloud.add({value(*x), value(*y), value(*z)}, intensity ? static_cast<float>(value(*intensity)) : 0.0F, CountFrom::origin);
    if (ring) cloud.ring.push_back(to_ring(value(*ring)));
    if (t) cloud.t.push_back(value(*t));
  }
  return cloud;
}

constexpr const char* kNoPoints = "remove the file; a missing scan is tolerated";

template <class T>
void keep_values(std::vector<T>& values, const std::vector<bool>& kept) {
  if (values.empty()) return;
  std::size_t next = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) values[next++] = values[i];
  values.resize(next);
}

// Keeps only the points for which `wanted` holds. Throws InputError if none is left.
template <class Wanted>
void keep_points(const fs::path& path, PointCloud& cloud, const char* remedy, const Wanted& wanted) {
  const std::size_t points = cloud.points.size();
  if (points == 0) throw InputError(path, "holds no points", remedy);
  std::vector<bool> kept(points);
  for (std::size_t i = 0; i < points; ++i) kept[i] = wanted(cloud.points[i]);
  if (std::find(kept.begin(), kept.end(), false) == kept.end()) return;
  cloud.file_points = points;
  cloud.file_index.resize(points);
  std::iota(cloud.file_index.begin(), cloud.file_index.end(), 0U);
  keep_values(cloud.file_index, kept), keep_values(cloud.points, kept), keep_values(cloud.intensity, kept),
      keep_values(cloud.t, kept), keep_values(cloud.ring, kept);
  if (cloud.points.empty())
    throw InputError(path, fmt::format("none of its {} points is a return: all are NaN or 0 0 0", points), remedy);
}

double load(const PointField& field, const char* at, bool swap) {
  switch (field.kind) {
    case 'f':
      return field.bytes == 8 ? load_number<double>(at, swap) : load_number<float>(at, swap);
    case 'i':
      return field.bytes == 1   ? load_number<std::int8_t>(at, swap)
             : field.bytes == 2 ? load_number<std::int16_t>(at, swap)
             : field.bytes == 4 ? load_number<std::int32_t>(at, swap)
                                : load_number<std::int64_t>(at, swap);
    default:
      return field.bytes == 1   ? load_number<std::uint8_t>(at, swap)
             : field.bytes == 2 ? load_number<std::uint16_t>(at, swap)
             : field.bytes == 4 ? load_number<std::uint32_t>(at, swap)
                                : load_number<std::uint64_t>(at, swap);
  }
}

[[noreturn]] void fail_short(const fs::path& path, std::size_t points) {
  throw InputError(path, "ends before its " + std::to_string(points) + " points", "the file is truncated; write it again");
}

// The columns that are used, with the index of each in a row, or -1.
class Columns {
 public:
  Columns(const fs::path& path, const PointTable& table) {
    const auto find = [&](std::initializer_list<const char*> names) {
      for (const char* name : names)
        for (std::size_t i = 0; i < table.fields.size(); ++i)
          if (to_lower_case(table.fields[i].name) == name && table.fields[i].count == 1) return static_cast<int>(i);
      return -1;
    };
    at_[0] = find({"x"}), at_[1] = find({"y"}), at_[2] = find({"z"});
    at_[3] = find({"intensity", "i", "scalar_intensity", "reflectance"});
    std::vector<std::string> names;
    for (const PointField& field : table.fields) names.push_back(field.count == 1 ? field.name : "");
    const std::optional<std::size_t> time = find_time_field(names);
    at_[4] = time ? static_cast<int>(*time) : -1, at_[5] = find({"ring"});
    for (int axis = 0; axis < 3; ++axis)
      if (at_[axis] < 0) throw InputError(path, "its points have no field '" + std::string(1, "xyz"[axis]) + "'");
  }

  /// Adds a point; number(i) is the value of field i.
  template <class Number>
  void add(PointCloud& cloud, const Number& number, CountFrom from) const {
    const auto exact = [&](int column) { return number(static_cast<std::size_t>(at_[column])); };
    const auto value = [&](int column) { return static_cast<float>(exact(column)); };
    const Eigen::Vector3d position(exact(0), exact(1), exact(2));
    if (from == CountFrom::first_point && !position.allFinite()) return;  // it would become the origin of all others
    cloud.add(position, at_[3] < 0 ? 0.0F : value(3), from);
    if (at_[4] >= 0) cloud.t.push_back(exact(4));
    if (at_[5] >= 0) cloud.ring.push_back(to_ring(exact(5)));
  }

 private:
  int at_[6];
};

PointCloud decode_binary(const fs::path& path, const PointTable& table, std::string_view data, CountFrom from) {
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < table.fields.size(); ++i) offsets.push_back(table.position(i));
  const std::size_t row = table.row_size();
  const Columns columns(path, table);
  if (data.size() / row < table.points) fail_short(path, table.points);
  const bool swap = table.data == PointTable::Data::big_endian;
  PointCloud cloud;
  cloud.points.reserve(table.points);
  for (std::size_t i = 0; i < table.points; ++i)
    columns.add(
        cloud, [&](std::size_t field) { return load(table.fields[field], data.data() + i * row + offsets[field], swap); },
        from);
  return cloud;
}

PointCloud decode_ascii(const fs::path& path, const PointTable& table, std::string_view data, CountFrom from) {
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < table.fields.size(); ++i) offsets.push_back(table.position(i));
  const std::size_t row = table.row_size();
  const Columns columns(path, table);
  PointCloud cloud;
  for (std::size_t i = 0; i < table.points; ++i) {
    if (data.empty()) fail_short(path, table.points);
    const std::size_t end = std::min(data.find('\n'), data.size());
    const std::vector<std::string> words = split_words(data.substr(0, end));
    data.remove_prefix(std::min(end + 1, data.size()));
    if (words.size() < row && data.empty()) fail_short(path, table.points);
    if (words.size() < row)
      throw InputError(path, fmt::format("point {} has {} numbers instead of {}", i, words.size(), row),
                       "write one line per point, with numbers separated by blanks");
    const auto number = [&](std::size_t field) {
      const std::string& word = words[offsets[field]];
      if (const auto value = to_number(word)) return *value;
      if (to_lower_case(word).find("nan") != std::string::npos || to_lower_case(word).find("inf") != std::string::npos)
        return std::nan("");
      throw InputError(path, "point " + std::to_string(i) + ": '" + word + "' is not a number");
    };
    columns.add(cloud, number, from);
  }
  return cloud;
}

}  // namespace

PointCloud decode_points(const fs::path& path, const PointTable& table, std::string_view data, CountFrom from) {
  if (table.fields.empty()) throw InputError(path, "its header declares no fields of points");
  return table.data == PointTable::Data::ascii ? decode_ascii(path, table, data, from) : decode_binary(path, table, data, from);
}

void check_size(const fs::path& path, std::size_t point_bytes) {
  const std::uintmax_t bytes = fs::exists(path) ? fs::file_size(path) : 0;
  if (bytes == 0) throw InputError(path, "holds no points", kNoPoints);
  if (is_bin(path) && bytes % point_bytes != 0)
    throw InputError(path, fmt::format("{} bytes are not a whole number of points of {} bytes", bytes, point_bytes),
                     "the file is truncated, or its columns are not those of the other scans: write it again");
}

PointCloud read_point_cloud(const fs::path& path, const BinLayout& layout) {
  const std::string ending = to_lower_case(path.extension().string());
  PointCloud cloud = ending == ".ply" ? read_ply(path) : ending == ".pcd" ? read_pcd(path) : read_bin(path, layout);
  keep_points(path, cloud, kNoPoints, is_return);
  return cloud;
}

PointCloud read_map_cloud(const fs::path& path) {
  const std::string ending = to_lower_case(path.extension().string());
  PointCloud cloud = ending == ".ply"   ? read_ply(path, CountFrom::first_point)
                     : ending == ".pcd" ? read_pcd(path, CountFrom::first_point)
                                        : read_las(path);
  cloud.t.clear();  // the times of a map have an unknown origin
  keep_points(path, cloud, "write the map again", [](const Eigen::Vector3f& point) { return point.allFinite(); });
  return cloud;
}

std::string to_bin_bytes(const Scan& scan) {
  std::string bytes(scan.size() * kBinPointBytes, '\0');
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::memcpy(bytes.data() + i * kBinPointBytes, scan.points[i].data(), 3 * sizeof(float));
    std::memcpy(bytes.data() + i * kBinPointBytes + 3 * sizeof(float), &scan.intensity[i], sizeof(float));
  }
  return bytes;
}

}  // namespace dvi::media
