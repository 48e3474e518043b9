#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/core/files.h"

namespace dvi::result {

/// What a file of a result was when it was written.
struct FileRecord {
  std::string file;  ///< relative to the result
  std::uint64_t bytes = 0;
  std::string hash;
};

/// InputError where one cannot be read.
std::vector<FileRecord> record_files(const fs::path& out, const std::vector<std::string>& files);

/// Says that files are finished and what they were made from: written after them. One that is missing, cut or of files that
/// have changed since says nothing.
struct Record {
  std::string fingerprint;  ///< of the options and inputs
  std::vector<FileRecord> files;
  std::shared_ptr<const nlohmann::json> frame = nullptr;  ///< of a single frame: frame_json()

  /// Whether the files are there as they were written.
  bool holds(const fs::path& out) const;
};

void write_record(const fs::path& file, const Record& record);
std::optional<Record> read_record(const fs::path& file);

}  // namespace dvi::result
