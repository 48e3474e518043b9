#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/media/point_table.h"

namespace dvi::media {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read as they lie in memory");

// Byte offsets in the public header block, which are the same in LAS 1.0 to 1.4.
constexpr std::size_t kMinorByte = 25, kDataByte = 96, kFormatByte = 104, kRecordByte = 105, kCountByte = 107, kScaleByte = 131,
                      kOffsetByte = 155;
constexpr std::size_t kMinHeaderBytes = 227, kLongCountByte = 247, kMinLongHeaderBytes = 375;  // the latter two of LAS 1.4
constexpr std::size_t kMinRecordBytes = 20;                                                    // size in point format 0
constexpr unsigned kMaxFormat = 10;

template <class T>
T at(const std::string& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

// The description of the points by the header.
struct Layout {
  std::size_t data = 0, record = 0, points = 0;
  Eigen::Vector3d scale, offset;
};

Layout read_layout(const fs::path& path, const std::string& bytes) {
  if (!bytes.starts_with("LASF")) throw InputError(path, "is not a LAS file");
  if (bytes.size() < kMinHeaderBytes)
    throw InputError(path, "its header is truncated", "the file is truncated; write it again");
  const auto minor = at<std::uint8_t>(bytes, kMinorByte), format = at<std::uint8_t>(bytes, kFormatByte);
  if (at<std::uint8_t>(bytes, kMinorByte - 1) != 1 || minor > 4)
    throw InputError(path, "is LAS " + std::to_string(at<std::uint8_t>(bytes, kMinorByte - 1)) + "." + std::to_string(minor),
                     "supported versions are 1.0 to 1.4");
  if (format > kMaxFormat)  // LASzip sets the highest bits
    throw InputError(path, format >= 0x40 ? "is compressed (LAZ), which is not supported" : "has points of an unknown format",
                     "write it as LAS, for example by pdal translate or las2las");
  Layout out;
  out.data = at<std::uint32_t>(bytes, kDataByte);
  out.record = at<std::uint16_t>(bytes, kRecordByte);
  out.points = at<std::uint32_t>(bytes, kCountByte);
  if (minor == 4 && bytes.size() >= kMinLongHeaderBytes) out.points = at<std::uint64_t>(bytes, kLongCountByte);
  for (int axis = 0; axis < 3; ++axis) {
    out.scale[axis] = at<double>(bytes, kScaleByte + 8 * static_cast<std::size_t>(axis));
    out.offset[axis] = at<double>(bytes, kOffsetByte + 8 * static_cast<std::size_t>(axis));
  }
  if (out.record < kMinRecordBytes || out.data < kMinHeaderBytes || !(out.scale.minCoeff() > 0) || !out.scale.allFinite() ||
      !out.offset.allFinite())
    throw InputError(path, "its header is damaged", "write it again");
  if (out.data > bytes.size() || (bytes.size() - out.data) / out.record < out.points)
    throw InputError(path, "ends before its " + std::to_string(out.points) + " points",
                     "the file is truncated; write it again");
  return out;
}

// Returns the unit of a coordinate system in well-known text if it is not meters; otherwise an empty text.
std::string find_foreign_unit(std::string_view text) {
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  if (has("GEOG") && !has("PROJC")) return "degrees";
  constexpr std::string_view kUnit = "UNIT[\"";
  constexpr double kMinFoot = 0.304, kMaxFoot = 0.305;
  for (std::size_t unit = text.find(kUnit); unit != std::string_view::npos; unit = text.find(kUnit, unit + 1)) {
    const std::size_t factor = text.find(',', unit), end = text.find_first_of(",]", factor + 1);
    if (factor == std::string_view::npos || end == std::string_view::npos) break;
    const std::optional<double> meters = to_number(text.substr(factor + 1, end - factor - 1));
    if (meters && *meters > kMinFoot && *meters < kMaxFoot) return "feet";
  }
  return "";
}

// Returns the same for the keys of GeoTIFF.
std::string find_foreign_unit_of_keys(const std::string& bytes, std::size_t place, std::size_t size) {
  constexpr std::uint16_t kModel = 1024, kGeographic = 2, kLinearUnits = 3076, kFoot = 9002, kUsFoot = 9003;
  constexpr std::size_t kEntryBytes = 8;  // key, location of the value (0: in the entry), count, value
  for (std::size_t entry = kEntryBytes; entry + kEntryBytes <= size; entry += kEntryBytes) {
    const auto key = at<std::uint16_t>(bytes, place + entry), value = at<std::uint16_t>(bytes, place + entry + 6);
    if (key == kModel && value == kGeographic) return "degrees";
    if (key == kLinearUnits && (value == kFoot || value == kUsFoot)) return "feet";
  }
  return "";
}

// Throws InputError if the variable length records between header and points declare another unit than meters.
void require_meters(const fs::path& path, const std::string& bytes, const Layout& layout) {
  constexpr std::size_t kHeaderSizeByte = 94, kRecordCountByte = 100, kRecordHeadBytes = 54, kRecordIdByte = 18;
  constexpr std::uint16_t kGeoKeys = 34735, kWellKnownText = 2112;
  std::size_t place = at<std::uint16_t>(bytes, kHeaderSizeByte);
  for (auto left = at<std::uint32_t>(bytes, kRecordCountByte); left > 0 && place + kRecordHeadBytes <= layout.data; --left) {
    const auto id = at<std::uint16_t>(bytes, place + kRecordIdByte), size = at<std::uint16_t>(bytes, place + kRecordIdByte + 2);
    place += kRecordHeadBytes;
    if (place + size > layout.data) return;
    const std::string unit = id == kGeoKeys         ? find_foreign_unit_of_keys(bytes, place, size)
                             : id == kWellKnownText ? find_foreign_unit(std::string_view(bytes).substr(place, size))
                                                    : "";
    if (!unit.empty())
      throw InputError(path, "its coordinate system is in " + unit,
                       "transform it to a projection in meters, such as UTM, for example by pdal translate with "
                       "filters.reprojection");
    place += size;
  }
}

}  // namespace

PointCloud read_las(const fs::path& path) {
  const std::string bytes = read_file(path);
  const Layout layout = read_layout(path, bytes);
  require_meters(path, bytes, layout);
  PointCloud cloud;
  cloud.points.reserve(layout.points);
  cloud.intensity.reserve(layout.points);
  for (std::size_t i = 0; i < layout.points; ++i) {
    const std::size_t place = layout.data + i * layout.record;
    const Eigen::Vector3d counts(at<std::int32_t>(bytes, place), at<std::int32_t>(bytes, place + 4),
                                 at<std::int32_t>(bytes, place + 8));
    const Eigen::Vector3d position = layout.offset + layout.scale.cwiseProduct(counts);
    cloud.add(position, static_cast<float>(at<std::uint16_t>(bytes, place + 12)) / 65535.0F);
  }
  return cloud;
}

}  // namespace dvi::media
