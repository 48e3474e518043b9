#include "dvi/media/deflate.h"

#include <memory>
#include <new>

#include <libdeflate.h>

namespace dvi::media {
namespace {

// The level of libdeflate. Level 3 takes twice as long and saves nothing on images of streets.
constexpr int kLevel = 1;

}  // namespace

std::string compress_zlib(const std::vector<std::uint8_t>& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(kLevel), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  const std::size_t bound = libdeflate_zlib_compress_bound(compressor.get(), bytes.size());
  const auto out = std::make_unique_for_overwrite<char[]>(bound);
  return {out.get(), libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.get(), bound)};
}

}  // namespace dvi::media
