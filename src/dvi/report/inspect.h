#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "dvi/core/files.h"

namespace dvi::report {

/// The image that a pixel was copied from.
struct ReceiptSource {
  std::size_t number = 0;  ///< as OUT/sources.json numbers it
  std::string drive, camera, frame;
  fs::path file;
  cv::Point2f position;             ///< px, to 1/16
  cv::Vec2i footprint;              ///< width and height in px over which its colors are averaged
  int averaged = 0;                 ///< sources whose colors went into the pixel
  std::array<int, 3> change{};      ///< RGB: what blending added to the copy, gray levels
  std::optional<int> frames_apart;  ///< signed, where both are frames of the target
};

/// Where one pixel of a result comes from.
struct Receipt {
  std::string frame;
  cv::Point pixel;
  std::string kind;                     ///< original, copied, copied from elsewhere, interpolated, synthesized, left empty
  std::array<int, 3> color{};           ///< RGB, as written
  std::optional<double> depth_m;        ///< none: unknown, or sky
  std::optional<double> confidence;     ///< of pixels that were filled
  std::optional<ReceiptSource> source;  ///< of pixels that were copied
};

/// InputError where `out` is no result, has no such frame (by name, or by its number of the drive), the pixel lies outside of
/// it, or a picture is missing.
Receipt read_receipt(const fs::path& out, const std::string& frame, cv::Point pixel);

std::string text_of(const Receipt& receipt);  ///< some lines for a person
std::string json_of(const Receipt& receipt);  ///< dvi-receipt/1

/// result.png, and of copies source.png, into the folder: what lies around the pixel, three times its size, with crosshairs.
/// The source is left out where its file is gone.
void write_crops(const fs::path& folder, const fs::path& out, const Receipt& receipt);

}  // namespace dvi::report
