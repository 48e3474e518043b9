#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/geometry/earth_place.h"

namespace dvi::exports {

/// "LAT,LON,HEADING". UsageError otherwise.
EarthPlace parse_origin(const std::string& text);

/// Where a raster lies. Meters east and north of the world's origin if its place is known, else in the drive's own world.
struct GeoPlace {
  double cell_m = 0, west_m = 0, north_m = 0;  ///< as Ground
  std::optional<EarthPlace> origin = {};

  /// GDAL's affine transform from pixels to the place.
  std::array<double, 6> transform() const;
  /// The coordinate system as PROJ has it; empty: local meters.
  std::string projection() const;
};

/// One band of a raster, 8-bit or 32-bit float, and what it holds.
struct GeoBand {
  cv::Mat values;
  std::string description;
};

/// Whether this build has GDAL.
bool can_write_geotiff();

/// Writes bands of one size and type; `alpha`: the last one tells where there is something; else NaN does. UsageError where
/// this build has no GDAL, InputError where the file cannot be written.
void write_geotiff(const fs::path& file, const GeoPlace& place, const std::vector<GeoBand>& bands, bool alpha);

}  // namespace dvi::exports
