#pragma once

#include <cstdint>
#include <filesystem>
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
  /// A file by its absolute path, size and time of change: cheap, and enough to notice that it was replaced.
  void add_file(const std::filesystem::path& path);
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dvi
