#include "dvi/bags/bag_metadata.h"

#include <fstream>
#include <sstream>

#include "dvi/core/text.h"

namespace dvi::bags {
namespace {

constexpr const char* kMetadataFile = "metadata.yaml";
constexpr const char* kMetadataRoot = "rosbag2_bagfile_information:";

// A line of YAML in block style: "  - key: value". The indentation is that of '-' if there is one.
struct YamlLine {
  std::size_t indentation = 0;
  bool is_item = false;
  std::string key, value;
};

std::string trim(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string remove_quotes(const std::string& text) {
  const bool is_quoted = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front();
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

YamlLine parse_line(const std::string& line) {
  YamlLine out;
  out.indentation = line.find_first_not_of(' ');
  std::string rest = trim(line);
  out.is_item = rest == "-" || rest.starts_with("- ");
  if (out.is_item) rest = trim(rest.substr(1));
  const std::size_t colon = rest.ends_with(':') ? rest.size() - 1 : rest.find(": ");
  if (colon == std::string::npos) {
    out.value = remove_quotes(rest);
  } else {
    out.key = rest.substr(0, colon);
    out.value = remove_quotes(trim(rest.substr(colon + 1)));
  }
  return out;
}

// Collects files and counts from the lines below the root.
class MetadataParser {
 public:
  void take(const YamlLine& line) {
    const bool begins_section = !line.is_item && (section_.empty() || line.indentation <= section_indentation_);
    if (begins_section) {
      finish_topic();
      section_ = line.key, section_indentation_ = line.indentation, item_indentation_.reset();
      return;
    }
    const bool begins_item = line.is_item && line.indentation == item_indentation_.value_or(line.indentation);
    if (begins_item) {
      finish_topic();
      item_indentation_ = line.indentation;
    }
    if (section_ == "relative_file_paths" && begins_item && !line.value.empty())
      metadata_.files.push_back(fs::path(line.value).filename().string());
    if (section_ != "topics_with_message_count") return;
    if (line.key == "name") topic_ = line.value;
    if (line.key == "message_count" && is_all_digits(line.value) && line.value.size() < 19) count_ = std::stoull(line.value);
  }

  BagMetadata finish() {
    finish_topic();
    return std::move(metadata_);
  }

 private:
  void finish_topic() {
    if (!topic_.empty() && count_) metadata_.counts[topic_] = *count_;
    topic_.clear(), count_.reset();
  }

  BagMetadata metadata_;
  std::string section_, topic_;
  std::size_t section_indentation_ = 0;
  std::optional<std::size_t> item_indentation_, count_;
};

}  // namespace

bool has_bag_metadata(const fs::path& folder) {
  if (fs::exists(folder / kMetadataFile)) require_regular_file(folder / kMetadataFile);
  std::ifstream stream(folder / kMetadataFile);
  std::string line(std::string(kMetadataRoot).size(), '\0');
  return stream.read(line.data(), static_cast<std::streamsize>(line.size())) && line == kMetadataRoot;
}

std::optional<BagMetadata> read_bag_metadata(const fs::path& folder) {
  if (!has_bag_metadata(folder)) return std::nullopt;
  std::istringstream text(read_settings(folder / kMetadataFile));
  MetadataParser parser;
  std::string line;
  std::getline(text, line);  // skips the root
  while (std::getline(text, line))
    if (!trim(line).empty() && !trim(line).starts_with('#')) parser.take(parse_line(line));
  return parser.finish();
}

}  // namespace dvi::bags
