#include "dvi/media/stored_png.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>

#include <libdeflate.h>

namespace dvi::media {
namespace {

constexpr std::size_t kSignatureBytes = 8, kHeaderBytes = 33;  // the header includes the signature
constexpr std::size_t kMaxStoredBlock = 65535;

std::uint32_t byte_at(const std::string& png, std::size_t at) { return static_cast<unsigned char>(png[at]); }
std::uint32_t number_at(const std::string& png, std::size_t at) {
  return byte_at(png, at) << 24 | byte_at(png, at + 1) << 16 | byte_at(png, at + 2) << 8 | byte_at(png, at + 3);
}

void append_big_endian(std::string& out, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(value >> shift));
}

/// Returns the size of the decompressed pixels with the byte of the filter of each row; nothing if it is not known.
std::optional<std::size_t> compute_raw_size(const std::string& png) {
  constexpr std::size_t kWidth = 16, kHeight = 20, kDepth = 24, kColorType = 25, kInterlacing = 28;
  constexpr std::size_t kMaxRawBytes = std::size_t{1} << 30;
  if (png.size() < kHeaderBytes || byte_at(png, kInterlacing) != 0) return std::nullopt;
  std::size_t channels = 1;
  switch (byte_at(png, kColorType)) {
    case 0:
    case 3:
      channels = 1;
      break;
    case 2:
      channels = 3;
      break;
    case 4:
      channels = 2;
      break;
    case 6:
      channels = 4;
      break;
    default:
      return std::nullopt;
  }
  const std::size_t width = number_at(png, kWidth), height = number_at(png, kHeight);
  const std::size_t size = height * (1 + (width * channels * byte_at(png, kDepth) + 7) / 8);
  return size <= kMaxRawBytes ? std::optional(size) : std::nullopt;
}

std::optional<std::string> decompress(const std::string& zlib, std::size_t size) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  std::string out(size, '\0');
  const libdeflate_result result =
      libdeflate_zlib_decompress(decompressor.get(), zlib.data(), zlib.size(), out.data(), out.size(), nullptr);
  return result == LIBDEFLATE_SUCCESS ? std::optional(std::move(out)) : std::nullopt;
}

/// Appends a chunk with pixels in the zlib format (RFC 1950) in stored blocks (RFC 1951, 3.2.4).
void append_stored_pixels(std::string& out, const std::string& raw) {
  const std::size_t blocks = std::max<std::size_t>(1, (raw.size() + kMaxStoredBlock - 1) / kMaxStoredBlock);
  append_big_endian(out, static_cast<std::uint32_t>(raw.size() + 5 * blocks + 6));
  const std::size_t begin = out.size();
  out += "IDAT\x78\x01";
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t first = block * kMaxStoredBlock, size = std::min(kMaxStoredBlock, raw.size() - first);
    out.push_back(block + 1 == blocks ? '\1' : '\0');
    for (const std::size_t value : {size, ~size}) {
      out.push_back(static_cast<char>(value));
      out.push_back(static_cast<char>(value >> 8));
    }
    out.append(raw, first, size);
  }
  append_big_endian(out, libdeflate_adler32(1, raw.data(), raw.size()));
  append_big_endian(out, libdeflate_crc32(0, out.data() + begin, out.size() - begin));
}

}  // namespace

std::optional<std::string> store_png(const std::string& png) {
  const std::optional<std::size_t> size = compute_raw_size(png);
  if (!size) return std::nullopt;
  std::string pixels, before = png.substr(0, kSignatureBytes), after;
  for (std::size_t at = kSignatureBytes; at + 12 <= png.size();) {
    const std::size_t length = number_at(png, at);
    if (length > png.size() - at - 12) return std::nullopt;
    if (png.compare(at + 4, 4, "IDAT") == 0)
      pixels.append(png, at + 8, length);
    else
      (pixels.empty() ? before : after).append(png, at, length + 12);
    at += length + 12;
  }
  const std::optional<std::string> raw = decompress(pixels, *size);
  if (!raw) return std::nullopt;
  before.reserve(before.size() + raw->size() + raw->size() / 1000 + after.size() + 100);
  append_stored_pixels(before, *raw);
  return before + after;
}

}  // namespace dvi::media
