#include "dvi/exports/map_cloud.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <map>
#include <string>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::exports {
namespace {

constexpr const char* kRunAgainRemedy = "run the same dvi run again, which rewrites the map";

struct PlyHeader {
  std::size_t points = 0, point_bytes = 0;
  std::map<std::string, std::size_t> offset;  // byte offset of each property by name
};

PlyHeader read_header(const fs::path& path, std::istream& in) {
  PlyHeader header;
  std::string line;
  bool binary = false;
  while (std::getline(in, line) && line != "end_header") {
    const std::vector<std::string> words = split_words(line);
    if (words.size() == 3 && words[0] == "format") binary = words[1] == "binary_little_endian";
    if (words.size() == 3 && words[0] == "element") {
      const std::optional<double> count = to_number(words[2]);
      if (words[1] != "vertex" || !count || *count < 0) throw InputError(path, "has no points", kRunAgainRemedy);
      header.points = static_cast<std::size_t>(*count);
    }
    if (words.size() != 3 || words[0] != "property") continue;
    if (words[1] != "float" && words[1] != "uchar") throw InputError(path, "has values of type " + words[1], kRunAgainRemedy);
    header.offset[words[2]] = header.point_bytes;
    header.point_bytes += words[1] == "float" ? 4 : 1;
  }
  if (binary && header.points == 0)
    throw InputError(path, "holds no points: no pixel was copied in this result",
                     "add the data that dvi check reports as missing, then run it again");
  for (const char* name : {"x", "y", "z", "red", "green", "blue", "nx", "ny", "nz", "intensity", "first", "last"})
    if (!binary || !header.offset.contains(name))
      throw InputError(path, fmt::format("is not a map of dvi ('{}')", name), kRunAgainRemedy);
  return header;
}

CloudPoint to_point(const PlyHeader& header, const char* bytes) {
  const auto number = [&](const char* name) {
    float value = 0;
    std::memcpy(&value, bytes + header.offset.at(name), sizeof value);
    return value;
  };
  const auto byte = [&](const char* name) { return static_cast<uchar>(bytes[header.offset.at(name)]); };
  return {{number("x"), number("y"), number("z")},
          {byte("blue"), byte("green"), byte("red")},
          {number("nx"), number("ny"), number("nz")},
          number("intensity"),
          number("first"),
          number("last")};
}

std::size_t find_stride(std::size_t points, std::size_t most) {
  return most == 0 ? 1 : std::max<std::size_t>(1, (points + most - 1) / most);
}

}  // namespace

std::vector<CloudPoint> read_map_cloud(const fs::path& ply, std::size_t most) {
  std::ifstream in(ply, std::ios::binary);
  if (!in) throw InputError(ply, "cannot be read", kRunAgainRemedy);
  const PlyHeader header = read_header(ply, in);
  const auto begin = static_cast<std::uintmax_t>(in.tellg());
  if ((fs::file_size(ply) - begin) / header.point_bytes < header.points)
    throw InputError(ply, fmt::format("is truncated: its header declares {} points", header.points), kRunAgainRemedy);
  std::vector<CloudPoint> cloud;
  const std::size_t every = find_stride(header.points, most);
  cloud.reserve(header.points / every + 1);
  std::string bytes(header.point_bytes, '\0');
  for (std::size_t i = 0; i < header.points && in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())); ++i)
    if (i % every == 0) cloud.push_back(to_point(header, bytes.data()));
  return cloud;
}

std::vector<CloudPoint> thin_cloud(const std::vector<CloudPoint>& cloud, std::size_t most) {
  std::vector<CloudPoint> out;
  for (std::size_t i = 0, every = find_stride(cloud.size(), most); i < cloud.size(); i += every) out.push_back(cloud[i]);
  return out;
}

}  // namespace dvi::exports
