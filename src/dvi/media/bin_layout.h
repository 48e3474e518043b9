#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/media/point_times.h"

namespace dvi::media {

/// The type and number of the columns of a .bin file: rows of numbers without a header.
struct BinShape {
  std::size_t scalar_bytes = 4;  ///< 4: float32, 8: float64
  std::size_t columns = 4;

  constexpr std::size_t point_bytes() const { return scalar_bytes * columns; }
  bool operator==(const BinShape&) const = default;
};

/// Returns whether a file is a .bin by its ending.
bool is_bin(const fs::path& file);

/// Formats a shape: "5 columns of float32".
std::string to_text(const BinShape& shape);

/// The meaning of the columns of .bin files.
struct BinLayout {
  std::size_t scalar_bytes = 4;
  /// The names x, y, z, intensity, ring, and t are used; columns with other names are ignored.
  std::vector<std::string> columns = {"x", "y", "z", "intensity"};

  bool stated = false;  ///< stated by the user, or checked before: it is not compared with the values of a file

  BinShape shape() const { return {scalar_bytes, columns.size()}; }
  /// Formats the layout: "5 columns of float32: x y z intensity ring".
  std::string text() const;
};

/// Infers the shape of a .bin file from its bytes, which may be truncated. With the right number of columns, each column holds
/// values of one kind; with a wrong one, the columns are mixed and their distributions become similar. Returns nothing if the
/// file has too few points or if its columns do not differ.
std::optional<BinShape> infer_bin_shape(std::string_view bytes);

/// Infers the layout of a set of .bin files from up to three of them: the shape from the values, rings by their elevations,
/// times by their range and order. Files that do not determine it have float32 x y z intensity. Throws InputError if their
/// sizes match no layout, if files have different shapes, or if there are more than eight columns. `scan` describes the last
/// file.
BinLayout infer_bin_layout(const std::vector<fs::path>& files, const TimedScan& scan);

/// Returns the layout with columns that the user states. Throws InputError if the sizes of files do not match it.
BinLayout use_stated_layout(const std::vector<fs::path>& files, const std::vector<std::string>& columns);

/// Reads a value of a .bin file whose bytes begin at `at`.
double load_scalar(const char* at, std::size_t scalar_bytes);

}  // namespace dvi::media
