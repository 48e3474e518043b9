#include "dvi/labels/class_names.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::labels {
namespace {

using Text = std::string_view;

constexpr auto kYamlFiles = std::to_array<Text>({"data.yaml", "data.yml", "dataset.yaml", "dataset.yml"});
constexpr auto kListFiles = std::to_array<Text>({"classes.txt", "obj.names", "_darknet.labels"});
constexpr auto kOtherLists = std::to_array<Text>({"labels.txt", "train.txt", "val.txt", "valid.txt", "test.txt", "readme.txt",
                                                  "readme.roboflow.txt", "readme.dataset.txt", "notes.txt"});

Text trim(Text text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == Text::npos ? Text() : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Removes a comment: '#' at the beginning or after a blank, outside quotes.
Text remove_comment(Text line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quote != 0)
      quote = line[i] == quote ? '\0' : quote;
    else if (line[i] == '"' || line[i] == '\'')
      quote = line[i];
    else if (line[i] == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t'))
      return line.substr(0, i);
  }
  return line;
}

Text remove_quotes(Text text) {
  text = trim(text);
  const bool is_quoted = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.back() == text.front();
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

// Splits "a, 'b, c', d" at the commas outside quotes.
std::vector<Text> split_items(Text list) {
  std::vector<Text> items;
  std::size_t begin = 0;
  char quote = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (quote != 0)
      quote = list[i] == quote ? '\0' : quote;
    else if (list[i] == '"' || list[i] == '\'')
      quote = list[i];
    else if (list[i] == ',')
      items.push_back(trim(list.substr(begin, i - begin))), begin = i + 1;
  }
  if (const Text last = trim(list.substr(begin)); !last.empty()) items.push_back(last);
  return items;
}

/// Collects the items below the key `names`.
class NamesParser {
 public:
  /// Adds an item of a list.
  void add(Text name) { names_[next_++] = to_lower_case(std::string(remove_quotes(name))); }
  /// Adds "NUMBER: name". Returns false if it is not one.
  bool add_entry(Text entry) {
    const std::size_t colon = entry.find(':');
    const auto number = colon == Text::npos ? std::nullopt : to_integer(remove_quotes(entry.substr(0, colon)));
    if (!number || *number < 0) return false;
    names_[*number] = to_lower_case(std::string(remove_quotes(entry.substr(colon + 1))));
    return true;
  }
  /// Adds "[a, b]" or "{0: a, 1: b}".
  bool add_brackets(Text text) {
    text = trim(text);
    const bool is_list = text.starts_with('[') && text.ends_with(']'), is_map = text.starts_with('{') && text.ends_with('}');
    if (!is_list && !is_map) return false;
    for (const Text item : split_items(text.substr(1, text.size() - 2))) {
      if (is_list) add(item);
      if (is_map && !add_entry(item)) return false;
    }
    return true;
  }
  std::map<int, std::string> take() { return std::move(names_); }

 private:
  std::map<int, std::string> names_;
  int next_ = 0;
};

bool is_complete(Text brackets) { return brackets.find_first_of("]}") != Text::npos; }

// Returns the names of a YAML document; none if the key is missing or has another form.
std::map<int, std::string> parse_yaml_names(const std::vector<Text>& lines) {
  constexpr Text kKey = "names:";
  const auto key = std::find_if(lines.begin(), lines.end(), [&](Text line) { return line.starts_with(kKey); });
  if (key == lines.end()) return {};
  NamesParser parser;
  std::string brackets(trim(key->substr(kKey.size())));
  for (auto line = key + 1; line != lines.end(); ++line) {
    const Text item = trim(*line);
    if (item.empty()) continue;
    if (!brackets.empty()) {
      if (is_complete(brackets)) break;
      brackets += " " + std::string(item);
      continue;
    }
    const bool is_item = item == "-" || item.starts_with("- ");
    if (!is_item && line->front() != ' ') break;  // the next key
    if (is_item)
      parser.add(item.substr(1));
    else if (!parser.add_entry(item))
      return {};
  }
  if (!brackets.empty() && !parser.add_brackets(brackets)) return {};
  return parser.take();
}

ClassNames read_yaml(const fs::path& file) {
  const std::string text = read_settings(file);
  std::vector<Text> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(remove_comment(Text(text).substr(at, end - at)));
    at = end + 1;
  }
  ClassNames out{parse_yaml_names(lines), file};
  if (out.names.empty())
    throw InputError(file, "has no names of classes", "write them as names: [car, truck] or names: {0: car, 1: truck}");
  return out;
}

ClassNames read_list(const fs::path& file) {
  ClassNames out{{}, file};
  read_settings(file);  // throws an error about sizes
  for (int number = 0; const std::string& line : read_lines(file)) {
    if (!trim(line).empty()) out.names[number] = to_lower_case(std::string(trim(line)));
    ++number;
  }
  return out;
}

}  // namespace

ClassNames find_class_names(const fs::path& folder) {
  constexpr int kMaxLevels = 3;  // labels/train/ below data.yaml
  fs::path at = fs::absolute(folder).lexically_normal();
  if (!at.has_filename()) at = at.parent_path();
  for (int level = 0; level < kMaxLevels; ++level, at = at.parent_path()) {
    for (const Text name : kYamlFiles)
      if (fs::is_regular_file(at / name)) return read_yaml(at / name);
    for (const Text name : kListFiles)
      if (fs::is_regular_file(at / name)) return read_list(at / name);
  }
  return {};
}

bool is_yolo_list(const fs::path& file) {
  const std::string name = to_lower_case(file.filename().string());
  const auto has = [&](const auto& names) { return std::find(names.begin(), names.end(), name) != names.end(); };
  return has(kListFiles) || has(kOtherLists);
}

}  // namespace dvi::labels
