#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/core/files.h"

namespace dvi::result {

/// A file of a result, with its size and hash at the time it was written.
struct ListedFile {
  std::string file;  ///< relative to the result
  std::uint64_t bytes = 0;
  std::string hash;
};

/// Lists files of a result with their sizes and hashes. Throws InputError if a file cannot be read.
std::vector<ListedFile> list_contents(const fs::path& out, const std::vector<std::string>& files);

/// Marks a part of a result as finished, and identifies its inputs: a JSON file that is written after the files that it lists.
/// A part whose manifest is missing, damaged, or has another fingerprint is not finished.
struct Manifest {
  std::string fingerprint;  ///< of everything that the part depends on
  std::vector<ListedFile> files{};
  std::shared_ptr<const nlohmann::json> content = nullptr;  ///< further data, which depend on the kind of the part

  /// Whether the part was made from this fingerprint, and all listed files exist and are unchanged.
  bool confirms(const std::string& made_from, const fs::path& out) const;
};

void write_manifest(const fs::path& file, const Manifest& manifest);

/// Reads a manifest; none if the file is missing or was changed after it was written. Its seal, the hash of the document,
/// detects changes that are valid JSON.
std::optional<Manifest> read_manifest(const fs::path& file);

/// Whether a manifest exists and confirms() its part.
bool is_confirmed(const fs::path& file, const std::string& fingerprint, const fs::path& out);

/// Writes a manifest that lists no files.
void write_manifest(const fs::path& file, const std::string& fingerprint, const nlohmann::json& content);

}  // namespace dvi::result
