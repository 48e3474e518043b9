#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/core/files.h"

namespace dvi::result {

/// A file of a result as it was when it was written.
struct ListedFile {
  std::string file;  ///< relative to the result
  std::uint64_t bytes = 0;
  std::string hash;
};

/// Lists files of a result with their sizes and hashes. InputError where one cannot be read.
std::vector<ListedFile> list_contents(const fs::path& out, const std::vector<std::string>& files);

/// Says that a part of a result is finished, and from what it was made: a JSON file, written after the files that it lists. A
/// manifest that is missing, truncated, or of another fingerprint says nothing.
struct Manifest {
  std::string fingerprint;  ///< of all that the part depends on
  std::vector<ListedFile> files{};
  std::shared_ptr<const nlohmann::json> content = nullptr;  ///< what else is known of the part; its kind defines it

  /// Whether the files are there as they were written.
  bool holds(const fs::path& out) const;
};

void write_manifest(const fs::path& file, const Manifest& manifest);
std::optional<Manifest> read_manifest(const fs::path& file);

/// Writes a manifest of content alone.
void write_manifest(const fs::path& file, const std::string& fingerprint, const nlohmann::json& content);

}  // namespace dvi::result
