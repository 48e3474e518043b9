#include "dvi/core/hash.h"

#include <sys/stat.h>

#include <cstdint>
#include <fstream>

#include <fmt/format.h>
#include <xxhash.h>

#include "dvi/core/error.h"
#include "dvi/core/files.h"

namespace dvi {

struct Fingerprint::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

Fingerprint::Fingerprint() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->xxh); }
Fingerprint::~Fingerprint() = default;

void Fingerprint::add(std::string_view bytes) {
  const std::uint64_t size = bytes.size();
  XXH3_128bits_update(state_->xxh, &size, sizeof size);  // distinguishes ("ab", "c") from ("a", "bc")
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

std::string Fingerprint::hex() const {
  const XXH128_hash_t h = XXH3_128bits_digest(state_->xxh);
  return fmt::format("{:016x}{:016x}", h.high64, h.low64);
}

std::string compute_hash(std::string_view bytes) {
  Fingerprint print;
  print.add(bytes);
  return print.hex();
}

namespace {

// An interrupted copy, or one from a damaged file system, can have its full size although almost nothing was written.
void require_written(const std::filesystem::path& path) {
  constexpr off_t kLargeBytes = off_t{1} << 30, kBlockBytes = 512, kMaxCompression = 64;
  struct stat status{};
  if (stat(path.c_str(), &status) != 0 || status.st_size <= kLargeBytes) return;
  const off_t written = status.st_blocks * kBlockBytes;
  if (written < status.st_size / kMaxCompression)
    throw InputError(path, fmt::format("has {} bytes, but only {} of them were written", status.st_size, written),
                     "the copy is incomplete; copy it again");
}

}  // namespace

std::string compute_file_hash(const std::filesystem::path& path, std::uintmax_t most) {
  require_regular_file(path, most);
  require_written(path);
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "cannot be read");
  Fingerprint print;
  std::string block(std::size_t{1} << 20, '\0');
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    print.add(std::string_view(block).substr(0, static_cast<std::size_t>(in.gcount())));
  }
  if (in.bad()) throw InputError(path, "cannot be read");
  return print.hex();
}

}  // namespace dvi
