#include "dvi/exports/geotiff.h"

#include <cmath>

#include <fmt/format.h>

#ifdef DVI_GDAL
#include <cpl_conv.h>
#include <gdal.h>
#include <ogr_srs_api.h>
#endif

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/geometry/angles.h"

namespace dvi::exports {

EarthPlace parse_origin(const std::string& text) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::optional<double> number = to_number(text.substr(begin, end - begin));
    if (!number) break;
    numbers.push_back(*number);
    begin = end + 1;
  }
  if (numbers.size() != 3 || begin <= text.size() || std::abs(numbers[0]) > 90 || std::abs(numbers[1]) > 180)
    throw UsageError(fmt::format("--origin {}: expected LAT,LON,HEADING in degrees, such as 49.01,8.43,90, or local", text));
  return {numbers[0], numbers[1], numbers[2]};
}

std::array<double, 6> GeoPlace::transform() const {
  if (!origin) return {west_m, cell_m, 0, north_m, 0, -cell_m};
  // World x points along the heading, and y to its left.
  const double heading = to_radians(origin->heading_deg), s = std::sin(heading), c = std::cos(heading);
  return {s * west_m - c * north_m, s * cell_m, c * cell_m, c * west_m + s * north_m, c * cell_m, -s * cell_m};
}

std::string GeoPlace::projection() const {
  if (!origin) return {};
  return fmt::format("+proj=aeqd +lat_0={:.9f} +lon_0={:.9f} +datum=WGS84 +units=m +no_defs", origin->latitude_deg,
                     origin->longitude_deg);
}

#ifdef DVI_GDAL

bool can_write_geotiff() { return true; }

namespace {

struct Close {
  void operator()(void* dataset) const { GDALClose(dataset); }
};

void require(bool holds, const fs::path& file, const char* step) {
  if (!holds)
    throw InputError(file, fmt::format("cannot be written by GDAL ({}: {})", step, CPLGetLastErrorMsg()), "free space");
}

void set_projection(GDALDatasetH dataset, const fs::path& file, const GeoPlace& place) {
  const std::string text = place.projection();
  if (text.empty()) return;
  const OGRSpatialReferenceH reference = OSRNewSpatialReference(nullptr);
  const bool is_set =
      OSRImportFromProj4(reference, text.c_str()) == OGRERR_NONE && GDALSetSpatialRef(dataset, reference) == CE_None;
  OSRDestroySpatialReference(reference);
  require(is_set, file, "coordinate system");
}

}  // namespace

void write_geotiff(const fs::path& file, const GeoPlace& place, const std::vector<GeoBand>& bands, bool alpha) {
  GDALAllRegister();
  const cv::Size size = bands.front().values.size();
  const GDALDataType type = bands.front().values.depth() == CV_8U ? GDT_Byte : GDT_Float32;
  const char* const with_alpha[] = {"COMPRESS=DEFLATE", "TILED=YES", "PHOTOMETRIC=RGB", "ALPHA=YES", nullptr};
  const char* const plain[] = {"COMPRESS=DEFLATE", "TILED=YES", nullptr};
  write_beside(file, [&](const fs::path& part) {
    std::unique_ptr<void, Close> dataset(GDALCreate(GDALGetDriverByName("GTiff"), part.c_str(), size.width, size.height,
                                                    static_cast<int>(bands.size()), type,
                                                    const_cast<char**>(alpha ? with_alpha : plain)));
    require(dataset != nullptr, file, "create");
    std::array<double, 6> transform = place.transform();
    require(GDALSetGeoTransform(dataset.get(), transform.data()) == CE_None, file, "place");
    set_projection(dataset.get(), file, place);
    for (std::size_t i = 0; i < bands.size(); ++i) {
      const GDALRasterBandH band = GDALGetRasterBand(dataset.get(), static_cast<int>(i) + 1);
      if (!alpha) GDALSetRasterNoDataValue(band, std::nan(""));
      GDALSetDescription(band, bands[i].description.c_str());
      cv::Mat values = bands[i].values;
      require(GDALRasterIO(band, GF_Write, 0, 0, size.width, size.height, values.data, size.width, size.height, type, 0,
                           static_cast<int>(values.step[0])) == CE_None,
              file, "pixels");
    }
    CPLErrorReset();
    dataset.reset();
    require(CPLGetLastErrorType() < CE_Failure, file, "close");
  });
}

#else

bool can_write_geotiff() { return false; }

void write_geotiff(const fs::path&, const GeoPlace&, const std::vector<GeoBand>&, bool) {
  throw UsageError("this build of dvi has no GDAL; install libgdal-dev and build it again");
}

#endif

}  // namespace dvi::exports
