#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <string_view>

#include "dvi/bags/bag_bytes.h"

namespace dvi::bags {

/// Writes a copy of a file in which some parts are replaced.
class ChangedCopy {
 public:
  ChangedCopy(const BagFile& from, fs::path to);

  /// Copies a part of the original, in pieces. Throws Interrupted after a signal.
  void keep(std::uint64_t at, std::uint64_t count);
  /// Writes `bytes` instead of `original`.
  void replace(std::string_view original, std::string_view bytes);
  /// Writes over bytes that were written earlier.
  void overwrite(std::uint64_t at, std::string_view bytes);
  std::uint64_t size() const { return size_; }  ///< bytes written so far
  /// Throws InputError if the disk is full.
  void finish();

  /// Receives each part of the original, and the part of the copy that replaces it; none by default.
  std::function<void(std::string_view original, std::string_view copy)> watch;

 private:
  void write(std::string_view bytes);

  const BagFile& from_;
  fs::path to_;
  std::ofstream out_;
  std::uint64_t size_ = 0;
};

}  // namespace dvi::bags
