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

/// The maximum size of a record, chunk, or message. Recorders write chunks of several megabytes; the limit keeps a damaged
/// length from exhausting the memory.
inline constexpr std::uint64_t kMaxBagRecordBytes = std::uint64_t{1} << 28;

/// Returns the size of a file. Throws InputError if it cannot be read, is not a regular file, or is empty.
std::uint64_t require_bag_file(const fs::path& path);

/// A large file whose parts can be read from any thread.
class BagFile {
 public:
  explicit BagFile(fs::path path);
  const fs::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Reads `count` bytes from byte `at`. Throws InputError with the byte if the file is shorter or `count` exceeds the maximum.
  std::string read(std::uint64_t at, std::uint64_t count) const;
  /// Throws an InputError about the byte `at`.
  [[noreturn]] void fail(std::uint64_t at, const std::string& problem) const;

 private:
  fs::path path_;
  std::uint64_t size_;
};

/// Returns the bytes of a number, little-endian.
template <class T>
std::string to_bytes(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Returns bytes after their size as 32-bit number, as ByteCursor::take_sized() reads them.
std::string with_size(std::string_view bytes);

/// Reads little-endian numbers and sized data from the front of bytes. Throws std::out_of_range if they are truncated.
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
  /// Reads a string or array that follows its length of type `Length`.
  template <class Length>
  std::string_view take_sized() {
    return take(take<Length>());
  }
  bool empty() const { return rest_.empty(); }
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

/// The chunks of a bag, decompressed on demand. The last few are cached.
class BagChunks {
 public:
  using Load = std::function<std::string(std::uint64_t place)>;
  explicit BagChunks(Load load) : load_(std::move(load)) {}
  std::shared_ptr<const std::string> operator[](std::uint64_t place);

 private:
  static constexpr std::size_t kMaxCached = 4;
  Load load_;
  std::mutex mutex_;
  std::list<std::pair<std::uint64_t, std::shared_ptr<const std::string>>> kept_;
};

/// Decompresses bytes of "lz4" (frames), "zstd" or "bz2"; returns bytes of "" and "none" unchanged. Throws
/// std::invalid_argument if that fails, if the result does not have `size` bytes, or if this build does not support the
/// compression.
std::string unpack(std::string_view compression, std::string_view bytes, std::uint64_t size);

/// Compresses bytes like a chunk that unpack() decompresses from `like`: LZ4 frames get the same parameters, since some readers
/// support only some of them. zstd and bz2 use their default level. Returns bytes of "" and "none" unchanged. Throws
/// std::invalid_argument if that fails.
std::string pack(std::string_view compression, std::string_view bytes, std::string_view like);

/// Decompresses a message that was compressed individually, as by rosbag2 with compression_mode message; returns others
/// unchanged.
std::string unpack_message(std::string bytes);

/// Compresses a message if `like`, the message that it replaces, was compressed individually; returns others unchanged.
std::string pack_message(std::string_view bytes, std::string_view like);

}  // namespace dvi::bags
