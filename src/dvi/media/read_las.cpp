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

// Places in the public header block, the same in LAS 1.0 to 1.4.
constexpr std::size_t kMinor = 25, kData = 96, kFormat = 104, kRecord = 105, kCount = 107, kScale = 131, kOffset = 155;
constexpr std::size_t kShortest = 227, kLongCount = 247, kShortestLong = 375;  // the header's size, and that of LAS 1.4
constexpr std::size_t kShortestRecord = 20;                                    // of point format 0
constexpr unsigned kMostFormat = 10;

template <class T>
T at(const std::string& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

// What the header says of the points.
struct Layout {
  std::size_t data = 0, record = 0, points = 0;
  Eigen::Vector3d scale, offset;
};

Layout read_layout(const fs::path& path, const std::string& bytes) {
  if (!bytes.starts_with("LASF")) throw InputError(path, "is no LAS file");
  if (bytes.size() < kShortest) throw InputError(path, "its header does not end", "the file was cut; write it again");
  const auto minor = at<std::uint8_t>(bytes, kMinor), format = at<std::uint8_t>(bytes, kFormat);
  if (at<std::uint8_t>(bytes, kMinor - 1) != 1 || minor > 4)
    throw InputError(path, "is LAS " + std::to_string(at<std::uint8_t>(bytes, kMinor - 1)) + "." + std::to_string(minor),
                     "1.0 to 1.4 are read");
  if (format > kMostFormat)  // LASzip sets the highest bits
    throw InputError(path, format >= 0x40 ? "is compressed (LAZ), which is not read" : "has points of an unknown format",
                     "write it as LAS, such as by pdal translate or las2las");
  Layout out;
  out.data = at<std::uint32_t>(bytes, kData);
  out.record = at<std::uint16_t>(bytes, kRecord);
  out.points = at<std::uint32_t>(bytes, kCount);
  if (minor == 4 && bytes.size() >= kShortestLong) out.points = at<std::uint64_t>(bytes, kLongCount);
  for (int axis = 0; axis < 3; ++axis) {
    out.scale[axis] = at<double>(bytes, kScale + 8 * static_cast<std::size_t>(axis));
    out.offset[axis] = at<double>(bytes, kOffset + 8 * static_cast<std::size_t>(axis));
  }
  if (out.record < kShortestRecord || out.data < kShortest || !(out.scale.minCoeff() > 0) || !out.scale.allFinite() ||
      !out.offset.allFinite())
    throw InputError(path, "its header is damaged", "write it again");
  if (out.data > bytes.size() || (bytes.size() - out.data) / out.record < out.points)
    throw InputError(path, "ends before its " + std::to_string(out.points) + " points do", "the file was cut; write it again");
  return out;
}

// The unit of a coordinate system as well-known text, where it is not meters; else empty.
std::string foreign_unit(std::string_view text) {
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

// The same of the keys of GeoTIFF.
std::string foreign_unit_of_keys(const std::string& bytes, std::size_t place, std::size_t size) {
  constexpr std::uint16_t kModel = 1024, kGeographic = 2, kLinearUnits = 3076, kFoot = 9002, kUsFoot = 9003;
  constexpr std::size_t kEntry = 8;  // key, where its value is (0: here), count, value
  for (std::size_t entry = kEntry; entry + kEntry <= size; entry += kEntry) {
    const auto key = at<std::uint16_t>(bytes, place + entry), value = at<std::uint16_t>(bytes, place + entry + 6);
    if (key == kModel && value == kGeographic) return "degrees";
    if (key == kLinearUnits && (value == kFoot || value == kUsFoot)) return "feet";
  }
  return "";
}

// By the variable length records between the header and the points.
void require_meters(const fs::path& path, const std::string& bytes, const Layout& layout) {
  constexpr std::size_t kHeaderSize = 94, kRecords = 100, kRecordHead = 54, kRecordId = 18;
  constexpr std::uint16_t kGeoKeys = 34735, kWellKnownText = 2112;
  std::size_t place = at<std::uint16_t>(bytes, kHeaderSize);
  for (auto left = at<std::uint32_t>(bytes, kRecords); left > 0 && place + kRecordHead <= layout.data; --left) {
    const auto id = at<std::uint16_t>(bytes, place + kRecordId), size = at<std::uint16_t>(bytes, place + kRecordId + 2);
    place += kRecordHead;
    if (place + size > layout.data) return;
    const std::string unit = id == kGeoKeys         ? foreign_unit_of_keys(bytes, place, size)
                             : id == kWellKnownText ? foreign_unit(std::string_view(bytes).substr(place, size))
                                                    : "";
    if (!unit.empty())
      throw InputError(path, "its coordinates are in " + unit + ", by its coordinate system",
                       "transform it to a projection in meters, such as UTM, by pdal translate with filters.reprojection");
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
