#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "dvi/core/files.h"

namespace dvi::report {

/// The image that a pixel was copied from.
struct PixelSource {
  std::size_t number = 0;  ///< index in OUT/sources.json
  std::string drive, camera, frame;
  fs::path file;
  cv::Point2f position;             ///< px, to 1/16
  cv::Vec2i footprint;              ///< width and height in px over which colors are averaged
  int averaged = 0;                 ///< number of sources whose colors were averaged
  std::array<int, 3> change{};      ///< RGB: change of the copy by blending, gray levels
  std::optional<int> frames_apart;  ///< signed; nothing unless both are frames of the target
};

/// The image of another program that a pixel was imported from.
struct ExternalSource {
  std::string file, hash;  ///< its path at the import, and the XXH3 of its bytes
};

/// The provenance of one pixel of a result.
struct PixelRecord {
  std::string frame;
  cv::Point pixel;
  std::string kind;               ///< original, copied, copied from elsewhere, interpolated, synthesized, left empty, imported
  std::array<int, 3> color{};     ///< RGB, as written
  std::optional<double> depth_m;  ///< nothing if unknown, or for the sky
  std::optional<double> confidence;        ///< only of filled pixels
  std::optional<PixelSource> source;       ///< only of copied pixels
  std::optional<ExternalSource> external;  ///< only of imported pixels
};

/// Reads the provenance of a pixel. Throws InputError if `out` is not a result, if it has no such frame (given by its name or
/// by its number in the drive), if the pixel is outside the frame, or if an image is missing.
PixelRecord read_pixel_record(const fs::path& out, const std::string& frame, cv::Point pixel);

std::string to_text(const PixelRecord& record);  ///< some lines for the terminal
std::string to_json(const PixelRecord& record);  ///< schema dvi-receipt/1

/// Writes result.png and, for copied pixels, source.png into the folder: the part of the image around the pixel, enlarged by
/// three, with crosshairs. The source is left out if its file is missing.
void write_crops(const fs::path& folder, const fs::path& out, const PixelRecord& record);

}  // namespace dvi::report
