#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "dvi/core/files.h"

namespace dvi::bags {

/// No record, chunk, or message of a bag has more bytes. Recorders write chunks of some megabytes; a damaged length must not
/// take all memory.
inline constexpr std::uint64_t kMaxBagRecordBytes = std::uint64_t{1} << 28;

/// The size of a file. InputError where it cannot be read, is not a regular file, or is empty.
std::uint64_t require_bag_file(const fs::path& path);

/// A large file of which parts are read, from any thread.
class BagFile {
 public:
  explicit BagFile(fs::path path);
  const fs::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// InputError naming the byte where the file ends before them, or they are more than a record has.
  std::string read(std::uint64_t at, std::uint64_t count) const;
  [[noreturn]] void fail(std::uint64_t at, const std::string& problem) const;

 private:
  fs::path path_;
  std::uint64_t size_;
};

/// Takes little-endian numbers and lengths off the front of bytes. std::out_of_range where they end too early.
class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  T take() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view take(std::uint64_t count);
  /// A string or array behind its length of type `Length`.
  template <class Length>
  std::string_view take_sized() {
    return take(take<Length>());
  }
  bool empty() const { return rest_.empty(); }
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

/// The chunks of a bag, unpacked on demand; the last few are kept.
class BagChunks {
 public:
  using Load = std::function<std::string(std::uint64_t place)>;
  explicit BagChunks(Load load) : load_(std::move(load)) {}
  std::shared_ptr<const std::string> operator[](std::uint64_t place);

 private:
  static constexpr std::size_t kKept = 4;
  Load load_;
  std::mutex mutex_;
  std::list<std::pair<std::uint64_t, std::shared_ptr<const std::string>>> kept_;
};

/// Unpacks what was compressed by "lz4" (frames), "zstd" or "bz2"; "" and "none" are left as they are. std::invalid_argument
/// where that fails, is not `size` bytes, or this program was built without that library.
std::string unpack(std::string_view compression, std::string_view bytes, std::uint64_t size);

/// A message that was compressed by itself, as rosbag2 does with compression_mode message; others are left as they are.
std::string unpack_message(std::string bytes);

}  // namespace dvi::bags
