#include "dvi/result/records.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/hash.h"
#include "dvi/core/json_file.h"
#include "dvi/core/json_text.h"
#include "dvi/result/report_json.h"

namespace dvi::result {
namespace {

constexpr const char* kRecordSchema = "dvi-record/1";

}  // namespace

static void to_json(nlohmann::json& json, const FileRecord& record) {
  json = {{"file", record.file}, {"bytes", record.bytes}, {"xxh3", record.hash}};
}
static void from_json(const nlohmann::json& json, FileRecord& record) {
  json.at("file").get_to(record.file);
  json.at("bytes").get_to(record.bytes);
  json.at("xxh3").get_to(record.hash);
}

std::vector<FileRecord> record_files(const fs::path& out, const std::vector<std::string>& files) {
  std::vector<FileRecord> records;
  for (const std::string& file : files) {
    const std::string hash = compute_file_hash(out / file);
    records.push_back({file, fs::file_size(out / file), hash});
  }
  return records;
}

bool Record::holds(const fs::path& out) const {
  return std::all_of(files.begin(), files.end(), [&](const FileRecord& record) {
    std::error_code gone;
    if (fs::file_size(out / record.file, gone) != record.bytes || gone) return false;
    try {
      return compute_file_hash(out / record.file) == record.hash;
    } catch (const InputError&) {  // answered: what cannot be read is made again
      return false;
    }
  });
}

void write_record(const fs::path& file, const Record& record) {
  nlohmann::json json{{"schema", kRecordSchema}, {"fingerprint", record.fingerprint}, {"files", record.files}};
  if (record.frame) json["frame"] = json_of(*record.frame);
  write_file(file, json_text(json));
}

std::optional<Record> read_record(const fs::path& file) {
  if (!fs::is_regular_file(file)) return std::nullopt;
  try {
    const nlohmann::json json = read_json(file);
    if (json.at("schema") != kRecordSchema) return std::nullopt;
    Record record{json.at("fingerprint"), json.at("files"), std::nullopt};
    if (json.contains("frame")) record.frame = frame_of(json.at("frame"));
    return record;
  } catch (const nlohmann::json::exception&) {  // answered: cut by a crash, or by hand
    return std::nullopt;
  }
}

}  // namespace dvi::result
