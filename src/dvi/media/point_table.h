#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dvi/media/point_cloud.h"

namespace dvi::media {

/// A field of each point as declared by the header of a PLY or PCD file.
struct PointField {
  std::string name;
  char kind = 'f';        ///< f: floating, i: signed, u: unsigned
  std::size_t bytes = 4;  ///< 1, 2, 4 or 8
  std::size_t count = 1;  ///< numbers per point; fields with several numbers are skipped
};

/// The description of the data by the header.
struct PointTable {
  std::vector<PointField> fields;
  std::size_t points = 0;
  enum class Data { ascii, little_endian, big_endian } data = Data::ascii;
  std::size_t rows = 1;     ///< of an organized PCD, whose points are the pixels of an image; 1 for others
  std::size_t data_at = 0;  ///< the byte at which the points begin
  bool has_others = false;  ///< whether a PLY has other elements after the points, such as faces

  /// Returns the position of a field in a row: in bytes, or in numbers of an ascii file.
  std::size_t position(std::size_t field) const;
  std::size_t row_size() const { return position(fields.size()); }  ///< in the same unit
};

/// Parse the header of a PLY or PCD file. Throw InputError if it is malformed.
PointTable parse_ply(const fs::path& path, std::string_view bytes);
PointTable parse_pcd(const fs::path& path, std::string_view bytes);

/// Decodes the data after a header. Throws InputError if they are shorter than declared or lack x, y, or z.
PointCloud decode_points(const fs::path& path, const PointTable& table, std::string_view data,
                         CountFrom from = CountFrom::origin);

/// Read a PLY or PCD file. Throw InputError if it is malformed or truncated.
PointCloud read_ply(const fs::path& path, CountFrom from = CountFrom::origin);
PointCloud read_pcd(const fs::path& path, CountFrom from = CountFrom::origin);
/// Reads LAS 1.0 to 1.4 in any point format, not compressed. The origin is the first point. Throws the same errors.
PointCloud read_las(const fs::path& path);

}  // namespace dvi::media
