#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

namespace dvi {

/// A 128-bit fingerprint of all added data in their order (XXH3).
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

/// Returns the fingerprint of bytes.
std::string compute_hash(std::string_view bytes);

/// Returns the fingerprint of a file's content. Throws InputError if the file cannot be read, exceeds `most` bytes, or has
/// gigabytes that were never written (holes of a sparse file).
std::string compute_file_hash(const std::filesystem::path& path,
                              std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max());

}  // namespace dvi
