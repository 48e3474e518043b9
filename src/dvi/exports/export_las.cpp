#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <ostream>
#include <string>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/version.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/map_cloud.h"

namespace dvi::exports {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

constexpr double kScaleM = 0.001;  // the unit of the whole-number coordinates
constexpr std::uint16_t kHeaderBytes = 227;
constexpr std::uint16_t kPointBytes = 34;  // size in format 3, with time and color

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put_text(std::string& bytes, const std::string& text, std::size_t size) {
  bytes += text.substr(0, size);
  bytes.append(size - std::min(size, text.size()), '\0');
}

// Makes the public header block of LAS 1.2.
std::string make_header(const std::vector<CloudPoint>& cloud) {
  Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
  if (!cloud.empty()) low = high = cloud.front().position;
  for (const CloudPoint& p : cloud) low = low.cwiseMin(p.position), high = high.cwiseMax(p.position);
  std::string out = "LASF";
  out.append(4 + 16, '\0');  // file source; global encoding: times are of the drive's own clock; no GUID
  out += '\1', out += '\2';
  put_text(out, "dvi", 32);
  put_text(out, fmt::format("dvi {}", kVersion), 32);
  put<std::uint16_t>(out, 0), put<std::uint16_t>(out, 0);  // no date, so that equal results have equal bytes
  put(out, kHeaderBytes), put<std::uint32_t>(out, kHeaderBytes), put<std::uint32_t>(out, 0);
  out += '\3', put(out, kPointBytes);
  put(out, static_cast<std::uint32_t>(cloud.size())), put(out, static_cast<std::uint32_t>(cloud.size()));
  for (int k = 1; k < 5; ++k) put<std::uint32_t>(out, 0);  // points by return: all are first returns
  for (int k = 0; k < 3; ++k) put(out, kScaleM);
  for (int k = 0; k < 3; ++k) put(out, 0.0);
  for (int axis = 0; axis < 3; ++axis) put(out, double{high[axis]}), put(out, double{low[axis]});
  return out;
}

void put_point(std::string& bytes, const CloudPoint& p, float brightest) {
  for (int axis = 0; axis < 3; ++axis) put(bytes, static_cast<std::int32_t>(std::lround(p.position[axis] / kScaleM)));
  put(bytes, static_cast<std::uint16_t>(std::clamp(65535 * p.intensity / brightest, 0.0F, 65535.0F)));
  bytes += '\x09';                    // the first of one return
  bytes.append(1 + 1 + 1 + 2, '\0');  // class (never classified), angle, user data, source
  put(bytes, double{p.first_s});
  for (const int channel : {2, 1, 0}) put(bytes, static_cast<std::uint16_t>(257 * p.color[channel]));
}

ExportReport write_las(const Result& result, const fs::path& folder, const ExportOptions&, Progress&) {
  const std::vector<CloudPoint> cloud = read_map_cloud(result.folder() / "map/map.ply");
  if (cloud.size() > std::numeric_limits<std::uint32_t>::max())
    throw InputError(result.folder() / "map/map.ply", "has more points than LAS 1.2 can count", "export ply");
  float brightest = std::numeric_limits<float>::min();
  for (const CloudPoint& p : cloud) brightest = std::max(brightest, p.intensity);
  write_stream(folder / "map.las", [&](std::ostream& out) {
    std::string bytes = make_header(cloud);
    for (const CloudPoint& p : cloud) {
      put_point(bytes, p, brightest);
      if (bytes.size() < (std::size_t{1} << 20)) continue;
      out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      bytes.clear();
    }
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
  return {{"map.las"}, {{"points", static_cast<double>(cloud.size())}}};
}

}  // namespace

ExportFormat las_format() {
  return {"las", "the static map as LAS 1.2, colored, with intensity and times (QGIS, PDAL, CloudCompare)", write_las};
}

}  // namespace dvi::exports
