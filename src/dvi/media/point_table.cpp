#include "dvi/media/point_table.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::media {
namespace {

// Reads the lines of a header one by one; the rest is data.
class Header {
 public:
  Header(const fs::path& path, std::string_view bytes) : path_(path), rest_(bytes) {}

  std::vector<std::string> next() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos)
      throw InputError(path_, "its header is truncated", "the file is truncated; write it again");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return split_words(line);
  }
  std::string_view rest() const { return rest_; }

 private:
  fs::path path_;
  std::string_view rest_;
};

[[noreturn]] void fail(const fs::path& path, const std::string& line) {
  throw InputError(path, "its header is not understood at '" + line + "'");
}

std::string join(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

std::size_t read_count(const fs::path& path, const std::vector<std::string>& words, std::size_t i) {
  const auto value = i < words.size() ? to_integer(words[i]) : std::nullopt;
  if (!value || *value < 0) fail(path, join(words));
  return static_cast<std::size_t>(*value);
}

PointField parse_ply_field(const fs::path& path, const std::vector<std::string>& words) {
  static const std::map<std::string, std::pair<char, std::size_t>> types = {
      {"char", {'i', 1}},  {"int8", {'i', 1}},    {"uchar", {'u', 1}},  {"uint8", {'u', 1}},
      {"short", {'i', 2}}, {"int16", {'i', 2}},   {"ushort", {'u', 2}}, {"uint16", {'u', 2}},
      {"int", {'i', 4}},   {"int32", {'i', 4}},   {"uint", {'u', 4}},   {"uint32", {'u', 4}},
      {"float", {'f', 4}}, {"float32", {'f', 4}}, {"double", {'f', 8}}, {"float64", {'f', 8}}};
  const auto type = words.size() == 3 ? types.find(words[1]) : types.end();
  if (type == types.end()) fail(path, join(words));
  return {words[2], type->second.first, type->second.second, 1};
}

PointTable::Data parse_ply_data(const fs::path& path, const std::string& name) {
  if (name == "ascii") return PointTable::Data::ascii;
  if (name == "binary_little_endian") return PointTable::Data::little_endian;
  if (name == "binary_big_endian") return PointTable::Data::big_endian;
  fail(path, "format " + name);
}

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PointField> fields;
};

// Skips an element before the vertices in the data, such as the camera of a scanner.
void skip_element(const fs::path& path, const PlyElement& element, PointTable::Data type, std::string_view& data) {
  std::size_t row = 0;
  for (const PointField& field : element.fields) row += field.bytes;
  if (row == 0) return;
  for (std::size_t i = 0; i < element.count; ++i) {
    const std::size_t line = std::min(data.find('\n'), data.size());
    const std::size_t size = type == PointTable::Data::ascii ? line + 1 : row;
    if (data.empty() || size > data.size())
      throw InputError(path, "ends before its points", "the file is truncated; write it again");
    data.remove_prefix(size);
  }
}

// FIELDS, SIZE, TYPE and COUNT are the columns of one table.
std::vector<PointField> parse_pcd_fields(const fs::path& path, std::map<std::string, std::vector<std::string>>& header) {
  const std::vector<std::string>&names = header["FIELDS"], &sizes = header["SIZE"], &types = header["TYPE"],
        &counts = header["COUNT"];
  std::vector<PointField> fields;
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::size_t bytes = read_count(path, sizes, i);
    const char kind = i < types.size() ? to_lower_case(types[i])[0] : '?';
    const bool known = kind == 'f' ? bytes == 4 || bytes == 8
                                   : (kind == 'i' || kind == 'u') && (bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8);
    if (!known) fail(path, join(types));
    fields.push_back({names[i], kind, bytes, counts.empty() ? 1 : read_count(path, counts, i)});
  }
  return fields;
}

bool is_pcd_entry(const std::string& word) {
  static const std::set<std::string> entries = {"VERSION", "FIELDS", "COLUMNS",   "SIZE",   "TYPE", "COUNT",
                                                "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  return entries.contains(word);
}

}  // namespace

std::size_t PointTable::position(std::size_t field) const {
  std::size_t position = 0;
  for (std::size_t i = 0; i < field; ++i) position += fields[i].count * (data == Data::ascii ? 1 : fields[i].bytes);
  return position;
}

PointTable parse_ply(const fs::path& path, std::string_view bytes) {
  if (!bytes.starts_with("ply")) throw InputError(path, "is not a PLY file");
  Header header(path, bytes);
  header.next();
  PointTable table;
  std::vector<PlyElement> elements;  // up to the vertices
  bool behind = false;               // whether the vertices have been declared
  for (auto words = header.next(); words.empty() || words[0] != "end_header"; words = header.next()) {
    const std::string key = words.empty() ? "comment" : words[0];
    if (key == "format" && words.size() >= 2) table.data = parse_ply_data(path, words[1]);
    if (key == "element" && words.size() == 3) {
      behind = behind || (!elements.empty() && elements.back().name == "vertex");
      table.has_others = table.has_others || (behind && read_count(path, words, 2) > 0);
      if (!behind) elements.push_back({words[1], read_count(path, words, 2), {}});
    }
    if (key == "property" && !behind && !elements.empty()) elements.back().fields.push_back(parse_ply_field(path, words));
  }
  if (elements.empty() || elements.back().name != "vertex") throw InputError(path, "holds no element 'vertex' with the points");
  table.fields = elements.back().fields;
  table.points = elements.back().count;
  elements.pop_back();
  std::string_view data = header.rest();
  for (const PlyElement& element : elements) skip_element(path, element, table.data, data);
  table.data_at = bytes.size() - data.size();
  return table;
}

PointTable parse_pcd(const fs::path& path, std::string_view bytes) {
  Header header(path, bytes);
  std::map<std::string, std::vector<std::string>> entries;
  while (!entries.contains("DATA")) {
    const auto words = header.next();
    if (words.empty() || words[0].starts_with('#')) continue;
    if (!is_pcd_entry(words[0])) fail(path, join(words));
    entries[words[0] == "COLUMNS" ? "FIELDS" : words[0]] = words;  // the name in versions before 0.7
  }
  PointTable table;
  table.fields = parse_pcd_fields(path, entries);
  table.points = entries.contains("POINTS") ? read_count(path, entries["POINTS"], 1)
                                            : read_count(path, entries["WIDTH"], 1) * read_count(path, entries["HEIGHT"], 1);
  const std::string data = join(entries["DATA"]);
  if (data == "DATA binary_compressed")
    throw InputError(path, "is compressed, which is not supported",
                     "write it as DATA binary or ascii, for example by pcl_convert_pcd_ascii_binary IN.pcd OUT.pcd 1");
  if (data != "DATA ascii" && data != "DATA binary") fail(path, data);
  table.data = data == "DATA ascii" ? PointTable::Data::ascii : PointTable::Data::little_endian;
  if (entries.contains("HEIGHT")) table.rows = read_count(path, entries["HEIGHT"], 1);
  table.data_at = bytes.size() - header.rest().size();
  return table;
}

PointCloud read_ply(const fs::path& path, CountFrom from) {
  const std::string bytes = read_file(path);
  const PointTable table = parse_ply(path, bytes);
  return decode_points(path, table, std::string_view(bytes).substr(table.data_at), from);
}

PointCloud read_pcd(const fs::path& path, CountFrom from) {
  const std::string bytes = read_file(path);
  const PointTable table = parse_pcd(path, bytes);
  return decode_points(path, table, std::string_view(bytes).substr(table.data_at), from);
}

}  // namespace dvi::media
