#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

namespace dvi {

/// A 128-bit fingerprint of everything that was added, in that order (XXH3).
class Fingerprint {
 public:
  Fingerprint();
  ~Fingerprint();
  Fingerprint(const Fingerprint&) = delete;
  Fingerprint& operator=(const Fingerprint&) = delete;

  void add(std::string_view bytes);
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::string hash_of(std::string_view bytes);

/// The fingerprint of what a file holds. InputError where it cannot be read, is larger than
/// `most` bytes, or has gigabytes that were never written (holes of a sparse file).
std::string hash_of_file(const std::filesystem::path& path, std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max());

}  // namespace dvi
