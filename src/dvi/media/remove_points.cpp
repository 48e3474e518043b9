#include "dvi/media/remove_points.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/media/point_table.h"

namespace dvi::media {
namespace {

// Divides the bytes of points, from `begin` on, into those of each of them.
std::vector<std::string_view> split_rows(const fs::path& path, std::string_view bytes, const PointTable& table) {
  std::vector<std::string_view> rows;
  std::size_t at = table.data_at;
  for (std::size_t i = 0; i < table.points; ++i) {
    const std::size_t line = std::min(bytes.find('\n', at), bytes.size() - 1) + 1 - at;
    const std::size_t size = table.data == PointTable::Data::ascii ? line : table.row_size();
    if (at >= bytes.size() || size > bytes.size() - at)
      throw InputError(path, fmt::format("ends before its {} points", table.points), "the file is truncated; write it again");
    rows.push_back(bytes.substr(at, size));
    at += size;
  }
  return rows;
}

std::string join_kept(const std::vector<std::string_view>& rows, const std::vector<bool>& removed) {
  std::string kept;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!removed[i]) kept += rows[i];
  return kept;
}

// Replaces the number at the end of the header's line that begins with `key`; a header without this line remains as it is.
void set_count(std::string& header, std::string_view key, std::size_t count) {
  std::size_t at = header.starts_with(key) ? 0 : header.find(fmt::format("\n{}", key));
  if (at == std::string::npos) return;
  at = header.find(key, at) + key.size();
  header.replace(at, header.find_first_of("\r\n", at) - at, fmt::format(" {}", count));
}

// Returns the fields of the coordinates, which a header that was read before has.
std::array<std::size_t, 3> find_coordinates(const PointTable& table) {
  std::array<std::size_t, 3> out{};
  for (std::size_t i = 0; i < table.fields.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (to_lower_case(table.fields[i].name) == std::string(1, "xyz"[axis])) out[axis] = i;
  return out;
}

std::string blank_line(std::string_view line, const PointTable& table) {
  std::vector<std::string> words = split_words(line);
  for (const std::size_t field : find_coordinates(table))
    if (const std::size_t word = table.position(field); word < words.size()) words[word] = "nan";
  return fmt::format("{}\n", fmt::join(words, " "));
}

std::string blank_row(std::string_view row, const PointTable& table) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr double kWideNan = std::numeric_limits<double>::quiet_NaN();
  std::string out(row);
  for (const std::size_t field : find_coordinates(table)) {
    const bool is_wide = table.fields[field].bytes == sizeof(double);
    const void* const value = is_wide ? static_cast<const void*>(&kWideNan) : &kNan;
    std::memcpy(out.data() + table.position(field), value, table.fields[field].bytes);
  }
  return out;
}

std::string blank_points(const fs::path& path, const PointTable& table, const std::vector<std::string_view>& rows,
                         const std::vector<bool>& removed) {
  for (const std::size_t field : find_coordinates(table))
    if (table.fields[field].kind != 'f')
      throw InputError(path, "has several rows of points, and their coordinates are integers, which cannot be NaN",
                       "write the coordinates as floats, or HEIGHT 1");
  std::string out;
  for (std::size_t i = 0; i < rows.size(); ++i)
    out += !removed[i]                             ? std::string(rows[i])
           : table.data == PointTable::Data::ascii ? blank_line(rows[i], table)
                                                   : blank_row(rows[i], table);
  return out;
}

void require_points(const fs::path& path, std::size_t points, const std::vector<bool>& removed) {
  if (points != removed.size())
    throw InputError(path, fmt::format("has {} points instead of {}", points, removed.size()), "write the file again");
}

PointTable make_bin_table(const fs::path& path, const std::string& bytes, std::size_t points) {
  if (points == 0 || bytes.size() % points != 0)
    throw InputError(path, fmt::format("{} bytes are not {} points", bytes.size(), points), "write the file again");
  return {.fields = {PointField{.name = "", .kind = 'u', .bytes = 1, .count = bytes.size() / points}},
          .points = points,
          .data = PointTable::Data::little_endian};
}

PointTable parse_table(const fs::path& path, const std::string& bytes, std::size_t points) {
  const std::string ending = to_lower_case(path.extension().string());
  return ending == ".ply"   ? parse_ply(path, bytes)
         : ending == ".pcd" ? parse_pcd(path, bytes)
                            : make_bin_table(path, bytes, points);
}

}  // namespace

std::string remove_points(const fs::path& path, const std::string& bytes, const std::vector<bool>& removed) {
  const PointTable table = parse_table(path, bytes, removed.size());
  require_points(path, table.points, removed);
  const auto lost = static_cast<std::size_t>(std::count(removed.begin(), removed.end(), true));
  if (lost == 0) return bytes;
  if (table.has_others)
    throw InputError(path, "has other elements after its points, such as faces, which refer to points by number",
                     "write the points only");
  std::string header = bytes.substr(0, table.data_at);
  const std::vector<std::string_view> rows = split_rows(path, bytes, table);
  if (table.rows > 1) return header + blank_points(path, table, rows, removed);
  for (const char* key : {"element vertex", "WIDTH", "POINTS"}) set_count(header, key, table.points - lost);
  return header + join_kept(rows, removed);
}

}  // namespace dvi::media
