#include "dvi/core/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace dvi {

struct Fingerprint::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

Fingerprint::Fingerprint() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->xxh); }
Fingerprint::~Fingerprint() = default;

void Fingerprint::add(std::string_view bytes) {
  const std::uint64_t size = bytes.size();
  XXH3_128bits_update(state_->xxh, &size, sizeof size);  // ("ab", "c") is not ("a", "bc")
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

void Fingerprint::add_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  const auto time = std::filesystem::last_write_time(path, error).time_since_epoch().count();
  add(fmt::format("{} {} {}", std::filesystem::absolute(path).lexically_normal().string(), size, time));
}

std::string Fingerprint::hex() const {
  const XXH128_hash_t h = XXH3_128bits_digest(state_->xxh);
  return fmt::format("{:016x}{:016x}", h.high64, h.low64);
}

}  // namespace dvi
