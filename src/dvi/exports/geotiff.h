#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/geometry/earth_place.h"

namespace dvi::exports {

/// Parses "LAT,LON,HEADING". Throws UsageError if it is malformed.
EarthPlace parse_origin(const std::string& text);

/// The position of a raster: meters east and north of the world's origin if its place is known, otherwise in the drive's own
/// world.
struct GeoPlace {
  double cell_m = 0, west_m = 0, north_m = 0;  ///< see GroundRaster
  std::optional<EarthPlace> origin = {};

  /// Returns GDAL's affine transform from pixels to positions.
  std::array<double, 6> transform() const;
  /// Returns the coordinate system in PROJ's notation; empty for local meters.
  std::string projection() const;
};

/// One band of a raster, 8-bit or 32-bit float, and its description.
struct GeoBand {
  cv::Mat values;
  std::string description;
};

/// Returns whether this build has GDAL.
bool can_write_geotiff();

/// Writes bands of the same size and type. With `alpha`, the last band states which pixels have data; otherwise NaN means no
/// data. Throws UsageError if this build has no GDAL, and InputError if the file cannot be written.
void write_geotiff(const fs::path& file, const GeoPlace& place, const std::vector<GeoBand>& bands, bool alpha);

}  // namespace dvi::exports
