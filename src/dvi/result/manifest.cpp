#include "dvi/result/manifest.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/hash.h"
#include "dvi/core/json_file.h"
#include "dvi/core/json_text.h"

namespace dvi::result {
namespace {

constexpr const char* kSchema = "dvi-manifest/1";

// Hashes a document without its seal, so that changes that are valid JSON are found.
std::string compute_seal(nlohmann::json document) {
  document.erase("seal");
  return compute_hash(json_text(document, -1));
}

}  // namespace

static void to_json(nlohmann::json& json, const ListedFile& listed) {
  json = {{"file", listed.file}, {"bytes", listed.bytes}, {"xxh3", listed.hash}};
}
static void from_json(const nlohmann::json& json, ListedFile& listed) {
  listed = {json.at("file"), json.at("bytes"), json.at("xxh3")};
}

std::vector<ListedFile> list_contents(const fs::path& out, const std::vector<std::string>& files) {
  std::vector<ListedFile> listed;
  for (const std::string& file : files) {
    const std::string hash = compute_file_hash(out / file);
    listed.push_back({file, fs::file_size(out / file), hash});
  }
  return listed;
}

bool Manifest::confirms(const std::string& made_from, const fs::path& out) const {
  return fingerprint == made_from && std::all_of(files.begin(), files.end(), [&](const ListedFile& listed) {
           std::error_code gone;
           if (fs::file_size(out / listed.file, gone) != listed.bytes || gone) return false;
           try {
             return compute_file_hash(out / listed.file) == listed.hash;
           } catch (const InputError&) {  // answered: an unreadable file is computed again
             return false;
           }
         });
}

void write_manifest(const fs::path& file, const Manifest& manifest) {
  nlohmann::json json{{"schema", kSchema}, {"fingerprint", manifest.fingerprint}, {"files", manifest.files}};
  if (manifest.content) json["content"] = *manifest.content;
  json["seal"] = compute_seal(json);
  write_file(file, json_text(json) + "\n");
}

void write_manifest(const fs::path& file, const std::string& fingerprint, const nlohmann::json& content) {
  write_manifest(file, {.fingerprint = fingerprint, .content = std::make_shared<const nlohmann::json>(content)});
}

std::optional<Manifest> read_manifest(const fs::path& file) {
  if (!fs::is_regular_file(file)) return std::nullopt;
  try {
    const nlohmann::json json = read_json(file);
    if (json.at("schema") != kSchema || json.at("seal") != compute_seal(json)) return std::nullopt;
    Manifest manifest{.fingerprint = json.at("fingerprint"), .files = json.at("files")};
    if (json.contains("content")) manifest.content = std::make_shared<const nlohmann::json>(json.at("content"));
    return manifest;
  } catch (const nlohmann::json::exception&) {  // answered: truncated by a crash, or changed by hand
    return std::nullopt;
  }
}

bool is_confirmed(const fs::path& file, const std::string& fingerprint, const fs::path& out) {
  const std::optional<Manifest> manifest = read_manifest(file);
  return manifest && manifest->confirms(fingerprint, out);
}

}  // namespace dvi::result
