#include "dvi/io/point_cloud.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "dvi/core/error.h"
#include "dvi/io/point_table.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBinPoint = 4 * sizeof(float);

PointCloud read_bin(const fs::path& path) {
  check_size(path);
  const std::string bytes = read_file(path);
  PointCloud cloud;
  cloud.points.resize(bytes.size() / kBinPoint);
  cloud.intensity.resize(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    std::memcpy(cloud.points[i].data(), bytes.data() + i * kBinPoint, 3 * sizeof(float));
    std::memcpy(&cloud.intensity[i], bytes.data() + i * kBinPoint + 3 * sizeof(float), sizeof(float));
  }
  return cloud;
}

constexpr const char* kNoPoints = "remove the file; dvi bridges a missing scan";

void check(const fs::path& path, const PointCloud& cloud, const char* remedy) {
  if (cloud.points.empty()) throw InputError(path, "holds no points", remedy);
  const auto bad = std::count_if(cloud.points.begin(), cloud.points.end(), [](const auto& p) { return !p.allFinite(); });
  if (bad > 0)
    throw InputError(path, std::to_string(bad) + " of " + std::to_string(cloud.points.size()) + " points are not finite (NaN)",
                     "leave such points out of the file");
  constexpr float kLongest = 10;  // seconds; beyond, the column is in another unit or counts from elsewhere
  if (std::any_of(cloud.t.begin(), cloud.t.end(), [](float t) { return !(std::abs(t) <= kLongest); }))
    throw InputError(path, "its times t are not seconds after the scan's start", "convert them or leave the field out");
}

template <class T>
double load(const char* at, bool swap) {
  char raw[sizeof(T)];
  std::memcpy(raw, at, sizeof(T));
  if (swap) std::reverse(raw, raw + sizeof(T));
  return static_cast<double>(std::bit_cast<T>(raw));
}

double load(const PointField& field, const char* at, bool swap) {
  switch (field.kind) {
    case 'f':
      return field.bytes == 8 ? load<double>(at, swap) : load<float>(at, swap);
    case 'i':
      return field.bytes == 1   ? load<std::int8_t>(at, swap)
             : field.bytes == 2 ? load<std::int16_t>(at, swap)
             : field.bytes == 4 ? load<std::int32_t>(at, swap)
                                : load<std::int64_t>(at, swap);
    default:
      return field.bytes == 1   ? load<std::uint8_t>(at, swap)
             : field.bytes == 2 ? load<std::uint16_t>(at, swap)
             : field.bytes == 4 ? load<std::uint32_t>(at, swap)
                                : load<std::uint64_t>(at, swap);
  }
}

[[noreturn]] void fail_short(const fs::path& path, std::size_t points) {
  throw InputError(path, "ends before its " + std::to_string(points) + " points do", "the file was cut; write it again");
}

// The columns that matter; the place of each in a row, or none.
class Columns {
 public:
  Columns(const fs::path& path, const PointTable& table) {
    const auto find = [&](std::initializer_list<const char*> names) {
      for (const char* name : names)
        for (std::size_t i = 0; i < table.fields.size(); ++i)
          if (table.fields[i].name == name && table.fields[i].count == 1) return static_cast<int>(i);
      return -1;
    };
    at_[0] = find({"x"}), at_[1] = find({"y"}), at_[2] = find({"z"});
    at_[3] = find({"intensity", "i", "scalar_intensity", "scalar_Intensity", "reflectance"});
    at_[4] = find({"t"}), at_[5] = find({"ring"});
    for (int axis = 0; axis < 3; ++axis)
      if (at_[axis] < 0) throw InputError(path, "its points have no field '" + std::string(1, "xyz"[axis]) + "'");
  }

  /// Adds a point; number(i) is the value of field i.
  template <class Number>
  void add(PointCloud& cloud, const Number& number, CountFrom from) const {
    const auto exact = [&](int column) { return number(static_cast<std::size_t>(at_[column])); };
    const auto value = [&](int column) { return static_cast<float>(exact(column)); };
    cloud.add({exact(0), exact(1), exact(2)}, at_[3] < 0 ? 0.0F : value(3), from);
    if (at_[4] >= 0) cloud.t.push_back(value(4));
    // In this order NaN becomes 0.
    if (at_[5] >= 0) cloud.ring.push_back(static_cast<std::uint16_t>(std::max(0.0F, std::min(value(5), 65535.0F))));
  }

 private:
  int at_[6];
};

PointCloud decode_binary(const fs::path& path, const PointTable& table, std::string_view data, CountFrom from) {
  std::vector<std::size_t> offsets;
  std::size_t row = 0;
  for (const PointField& field : table.fields) offsets.push_back(row), row += field.bytes * field.count;
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
  std::size_t row = 0;
  for (const PointField& field : table.fields) offsets.push_back(row), row += field.count;
  const Columns columns(path, table);
  PointCloud cloud;
  for (std::size_t i = 0; i < table.points; ++i) {
    if (data.empty()) fail_short(path, table.points);
    const std::size_t end = std::min(data.find('\n'), data.size());
    const std::vector<std::string> words = split_words(data.substr(0, end));
    data.remove_prefix(std::min(end + 1, data.size()));
    if (words.size() < row) fail_short(path, table.points);
    const auto number = [&](std::size_t field) {
      const std::string& word = words[offsets[field]];
      if (const auto value = to_number(word)) return *value;
      if (lower_case(word).find("nan") != std::string::npos || lower_case(word).find("inf") != std::string::npos)
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

void check_size(const fs::path& path) {
  const std::uintmax_t bytes = fs::exists(path) ? fs::file_size(path) : 0;
  if (bytes == 0) throw InputError(path, "holds no points", kNoPoints);
  if (path.extension() == ".bin" && bytes % kBinPoint != 0)
    throw InputError(path, std::to_string(bytes) + " bytes are no whole number of points",
                     "a point is 16 bytes: x y z intensity as float32");
}

PointCloud read_point_cloud(const fs::path& path) {
  const std::string ending = lower_case(path.extension().string());
  PointCloud cloud = ending == ".ply" ? read_ply(path) : ending == ".pcd" ? read_pcd(path) : read_bin(path);
  check(path, cloud, kNoPoints);
  return cloud;
}

PointCloud read_map_cloud(const fs::path& path) {
  const std::string ending = lower_case(path.extension().string());
  PointCloud cloud = ending == ".ply"   ? read_ply(path, CountFrom::first_point)
                     : ending == ".pcd" ? read_pcd(path, CountFrom::first_point)
                                        : read_las(path);
  cloud.t.clear();  // of a map, seconds since anything
  check(path, cloud, "write the map again");
  return cloud;
}

std::string bin_bytes(const Scan& scan) {
  std::string bytes(scan.size() * kBinPoint, '\0');
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::memcpy(bytes.data() + i * kBinPoint, scan.points[i].data(), 3 * sizeof(float));
    std::memcpy(bytes.data() + i * kBinPoint + 3 * sizeof(float), &scan.intensity[i], sizeof(float));
  }
  return bytes;
}

}  // namespace dvi::io
