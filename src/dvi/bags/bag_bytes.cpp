#include "dvi/bags/bag_bytes.h"

#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

#ifdef DVI_LZ4
#include <lz4frame.h>
#endif
#ifdef DVI_ZSTD
#include <zstd.h>
#endif
#ifdef DVI_BZ2
#include <bzlib.h>
#endif

namespace dvi::bags {
namespace {

constexpr std::uint64_t kMaxCompressionRatio = 4096;

[[noreturn]] [[maybe_unused]] void fail_without(std::string_view library) {
  throw std::invalid_argument(fmt::format("it is compressed by {}, which this build of dvi does not support", library));
}

std::string unpack_lz4([[maybe_unused]] std::string_view bytes, [[maybe_unused]] std::uint64_t size) {
#ifdef DVI_LZ4
  std::string out(size, '\0');
  LZ4F_dctx* context = nullptr;
  LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context, LZ4F_freeDecompressionContext);
  std::size_t from = 0, to = 0;
  while (from < bytes.size()) {
    std::size_t taken = bytes.size() - from, given = out.size() - to;
    const std::size_t result = LZ4F_decompress(context, out.data() + to, &given, bytes.data() + from, &taken, nullptr);
    if (LZ4F_isError(result)) throw std::invalid_argument(LZ4F_getErrorName(result));
    from += taken, to += given;
    if (result == 0 || (taken == 0 && given == 0)) break;
  }
  out.resize(to);
  return out;
#else
  fail_without("lz4");
#endif
}

std::string unpack_zstd([[maybe_unused]] std::string_view bytes, [[maybe_unused]] std::uint64_t size) {
#ifdef DVI_ZSTD
  std::string out(size, '\0');
  const std::size_t result = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(result) != 0) throw std::invalid_argument(ZSTD_getErrorName(result));
  out.resize(result);
  return out;
#else
  fail_without("zstd");
#endif
}

std::string unpack_bz2([[maybe_unused]] std::string_view bytes, [[maybe_unused]] std::uint64_t size) {
#ifdef DVI_BZ2
  std::string out(size, '\0');
  unsigned count = static_cast<unsigned>(out.size());
  const int result = BZ2_bzBuffToBuffDecompress(out.data(), &count, const_cast<char*>(bytes.data()),
                                                static_cast<unsigned>(bytes.size()), 0, 0);
  if (result != BZ_OK) throw std::invalid_argument(fmt::format("bzip2 reports error {}", result));
  out.resize(count);
  return out;
#else
  fail_without("bzip2");
#endif
}

std::string pack_lz4([[maybe_unused]] std::string_view bytes, [[maybe_unused]] std::string_view like) {
#ifdef DVI_LZ4
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  LZ4F_dctx* context = nullptr;
  LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context, LZ4F_freeDecompressionContext);
  std::size_t taken = like.size();
  const std::size_t known = LZ4F_getFrameInfo(context, &preferences.frameInfo, like.data(), &taken);
  if (LZ4F_isError(known)) throw std::invalid_argument(LZ4F_getErrorName(known));
  if (preferences.frameInfo.contentSize != 0) preferences.frameInfo.contentSize = bytes.size();
  std::string out(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t result = LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(result)) throw std::invalid_argument(LZ4F_getErrorName(result));
  out.resize(result);
  return out;
#else
  fail_without("lz4");
#endif
}

std::string pack_zstd([[maybe_unused]] std::string_view bytes) {
#ifdef DVI_ZSTD
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t result = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(result) != 0) throw std::invalid_argument(ZSTD_getErrorName(result));
  out.resize(result);
  return out;
#else
  fail_without("zstd");
#endif
}

std::string pack_bz2([[maybe_unused]] std::string_view bytes) {
#ifdef DVI_BZ2
  constexpr int kLargestBlock = 9;                                 // the default of the bzip2 program
  std::string out(bytes.size() + bytes.size() / 64 + 1024, '\0');  // the manual guarantees 1 % and 600 bytes
  unsigned count = static_cast<unsigned>(out.size());
  const int result = BZ2_bzBuffToBuffCompress(out.data(), &count, const_cast<char*>(bytes.data()),
                                              static_cast<unsigned>(bytes.size()), kLargestBlock, 0, 0);
  if (result != BZ_OK) throw std::invalid_argument(fmt::format("bzip2 reports error {}", result));
  out.resize(count);
  return out;
#else
  fail_without("bzip2");
#endif
}

constexpr std::string_view kZstdMagic = "\x28\xB5\x2F\xFD";

}  // namespace

std::uint64_t require_bag_file(const fs::path& path) {
  require_regular_file(path, std::numeric_limits<std::uintmax_t>::max());
  const std::uint64_t size = fs::file_size(path);
  if (size == 0) throw InputError(path, "is empty", "copy or record it again");
  return size;
}

BagFile::BagFile(fs::path path) : path_(std::move(path)), size_(require_bag_file(path_)) {}

std::string BagFile::read(std::uint64_t at, std::uint64_t count) const {
  if (at > size_ || count > size_ - at) fail(at, "the file ends within a record");
  if (count > kMaxBagRecordBytes)
    fail(at, fmt::format("a record of {} bytes is larger than the limit of {} bytes", count, kMaxBagRecordBytes));
  std::ifstream stream(path_, std::ios::binary);
  std::string bytes(count, '\0');
  stream.seekg(static_cast<std::streamoff>(at));
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(count))) fail(at, "cannot be read");
  return bytes;
}

void BagFile::fail(std::uint64_t at, const std::string& problem) const {
  const std::string ending = to_lower_case(path_.extension().string());
  const char* const tool = ending == ".mcap" ? "mcap recover" : "rosbag reindex";
  throw InputError(path_, fmt::format("byte {}: {}", at, problem),
                   fmt::format("the recording is truncated or damaged; repair it ({}) or record it again", tool));
}

std::string_view ByteCursor::take(std::uint64_t count) {
  if (count > rest_.size()) throw std::out_of_range("it is truncated");
  const std::string_view out = rest_.substr(0, count);
  rest_.remove_prefix(count);
  return out;
}

std::shared_ptr<const std::string> BagChunks::operator[](std::uint64_t place) {
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [at, chunk] : kept_)
      if (at == place) return chunk;
  }
  auto chunk = std::make_shared<const std::string>(load_(place));
  const std::scoped_lock lock(mutex_);
  kept_.emplace_front(place, chunk);
  if (kept_.size() > kMaxCached) kept_.pop_back();
  return chunk;
}

std::string unpack(std::string_view compression, std::string_view bytes, std::uint64_t size) {
  if (size > kMaxBagRecordBytes || size / kMaxCompressionRatio > bytes.size())
    throw std::invalid_argument(fmt::format("a size of {1} bytes is stated for {0} compressed bytes", bytes.size(), size));
  std::string out = compression.empty() || compression == "none" ? std::string(bytes)
                    : compression == "lz4"                       ? unpack_lz4(bytes, size)
                    : compression == "zstd"                      ? unpack_zstd(bytes, size)
                    : compression == "bz2"
                        ? unpack_bz2(bytes, size)
                        : throw std::invalid_argument(fmt::format("its compression '{}' is not supported", compression));
  if (out.size() != size) throw std::invalid_argument(fmt::format("it has {} bytes instead of {}", out.size(), size));
  return out;
}

std::string with_size(std::string_view bytes) {
  return to_bytes(static_cast<std::uint32_t>(bytes.size())) + std::string(bytes);
}

std::string pack(std::string_view compression, std::string_view bytes, std::string_view like) {
  if (compression == "lz4") return pack_lz4(bytes, like);
  if (compression == "zstd") return pack_zstd(bytes);
  if (compression == "bz2") return pack_bz2(bytes);
  return std::string(bytes);
}

std::string unpack_message(std::string bytes) {
  if (!bytes.starts_with(kZstdMagic)) return bytes;  // CDR begins with 00
#ifdef DVI_ZSTD
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw std::invalid_argument("it is compressed and does not state its size");
  return unpack("zstd", bytes, size);
#else
  fail_without("zstd");
#endif
}

std::string pack_message(std::string_view bytes, std::string_view like) {
  return pack(like.starts_with(kZstdMagic) ? "zstd" : "", bytes, like);
}

}  // namespace dvi::bags
