#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/media/point_times.h"

namespace dvi::media {

/// Type and number of the columns of a .bin file: rows of numbers without a header.
struct BinShape {
  std::size_t scalar_bytes = 4;  ///< 4: float32, 8: float64
  std::size_t columns = 4;

  constexpr std::size_t point_bytes() const { return scalar_bytes * columns; }
  bool operator==(const BinShape&) const = default;
};

/// Whether a file is a .bin by its ending.
bool is_bin(const fs::path& file);

/// "5 columns of float32".
std::string to_text(const BinShape& shape);

/// What the columns of .bin files hold.
struct BinLayout {
  std::size_t scalar_bytes = 4;
  /// x, y, z, intensity, ring, t; any other name is a column that is not used.
  std::vector<std::string> columns = {"x", "y", "z", "intensity"};

  bool stated = false;  ///< by the user: values that contradict it are read as stated

  BinShape shape() const { return {scalar_bytes, columns.size()}; }
  /// "5 columns of float32: x y z intensity ring".
  std::string text() const;
};

/// Infers the shape of a .bin file from its bytes. With the right number of columns, each column holds values of one kind;
/// with a wrong one, the columns mix, and their distributions become alike. The size of a file, which may be truncated, does
/// not matter. None where a file has too few points to tell, or where its columns do not differ.
std::optional<BinShape> infer_bin_shape(std::string_view bytes);

/// Infers the layout of a set of .bin files from up to three of them: the shape from the values, ring by its elevations, times
/// by their range and order. Files that do not tell hold float32 x y z intensity. InputError where their sizes fit no layout,
/// where files have different shapes, and for more than eight columns. `scan` describes the last file.
BinLayout infer_bin_layout(const std::vector<fs::path>& files, const TimedScan& scan);

/// The layout with columns that the user states; InputError where sizes do not fit it.
BinLayout stated_layout(const std::vector<fs::path>& files, const std::vector<std::string>& columns);

/// A value of a .bin file: its bytes begin at `at`.
double load_scalar(const char* at, std::size_t scalar_bytes);

}  // namespace dvi::media
