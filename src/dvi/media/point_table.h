#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dvi/media/point_cloud.h"

namespace dvi::media {

/// A number of each point as the header of a PLY or PCD file declares it.
struct PointField {
  std::string name;
  char kind = 'f';        ///< f: floating, i: signed, u: unsigned
  std::size_t bytes = 4;  ///< 1, 2, 4 or 8
  std::size_t count = 1;  ///< numbers in a row; only single ones are understood, others skipped
};

/// What a header says of the data behind it.
struct PointTable {
  std::vector<PointField> fields;
  std::size_t points = 0;
  enum class Data { ascii, little_endian, big_endian } data = Data::ascii;
};

/// Takes the data behind a header apart. InputError where they are shorter than declared or lack x, y, z.
PointCloud decode_points(const fs::path& path, const PointTable& table, std::string_view data,
                         CountFrom from = CountFrom::origin);

PointCloud read_ply(const fs::path& path, CountFrom from = CountFrom::origin);
PointCloud read_pcd(const fs::path& path, CountFrom from = CountFrom::origin);
/// LAS 1.0 to 1.4, any point format, not compressed; counted from the first point.
PointCloud read_las(const fs::path& path);

}  // namespace dvi::media
