#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/objects/detect/description.h"

namespace dvi::objects {
namespace {

constexpr int kMaxClasses = 10'000;

// Reads a text of Python in quotes that begins at `at`, and moves `at` behind it.
std::string read_quoted(const std::string& text, std::size_t& at) {
  const char quote = text[at++];
  std::string out;
  for (; at < text.size() && text[at] != quote; ++at) {
    if (text[at] == '\\' && at + 1 < text.size()) ++at;
    out += text[at];
  }
  ++at;
  return out;
}

// Reads a dictionary of Python whose keys are numbers: {0: 'person', 1: "driver's cab"}. Returns an empty list if the numbers
// are not 0, 1, 2, ... without gaps.
std::vector<std::string> read_numbered_names(const std::string& text) {
  std::map<int, std::string> names;
  std::string number;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '\'' || c == '"') {
      const auto value = to_integer(number);
      if (!value || *value < 0 || *value >= kMaxClasses) return {};
      names[*value] = to_lower_case(read_quoted(text, at));
      number.clear();
      continue;
    }
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) number += c;
    ++at;
  }
  std::vector<std::string> out;
  for (const auto& [value, name] : names) {
    if (value != static_cast<int>(out.size())) return {};
    out.push_back(name);
  }
  return out;
}

// Reads a list of two numbers, [height, width].
std::optional<cv::Size> read_size(const std::string& text) {
  const nlohmann::json sizes = nlohmann::json::parse(text, nullptr, false);
  if (!sizes.is_array() || sizes.size() != 2 || !sizes[0].is_number_integer() || !sizes[1].is_number_integer())
    return std::nullopt;
  return cv::Size(sizes[1].get<int>(), sizes[0].get<int>());
}

// The properties that Ultralytics writes into a network: names, imgsz, description.
void add_ultralytics(const std::map<std::string, std::string>& properties, Description& out) {
  const auto find = [&](const char* key) {
    const auto found = properties.find(key);
    return found == properties.end() ? std::string() : found->second;
  };
  out.classes = read_numbered_names(find("names"));
  if (const auto size = read_size(find("imgsz")); size && out.input.empty()) out.input = *size;
  const std::string description = to_lower_case(find("description"));
  if (description.find("rt-detr") == std::string::npos && description.find("rtdetr") == std::string::npos) return;
  out.fit = Fit::stretch;
  out.layout = Layout::detr;  // with two classes, its rows have as many numbers as those of Layout::nms
}

// Reads a JSON file beside the network; null if it does not exist.
nlohmann::json read_beside(const fs::path& model, const char* name, Description& out) {
  const fs::path file = model.parent_path() / name;
  if (!fs::is_regular_file(file)) return nullptr;
  const nlohmann::json json = nlohmann::json::parse(read_settings(file), nullptr, false);
  if (!json.is_object()) throw InputError(file, "is not a JSON object", "correct it, or move the network to another folder");
  out.files.push_back(file);
  return json;
}

std::optional<std::array<double, 3>> read_channels(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number()) return std::nullopt;
    out[i] = (*found)[i].get<double>();
  }
  return out;
}

// The preparation of images: resized to a size, scaled to 0..1 unless do_rescale is false, normalized if do_normalize is true.
void add_preparation(const nlohmann::json& json, Description& out) {
  if (const auto size = json.find("size"); size != json.end() && size->is_object() && size->contains("height")) {
    out.fit = Fit::stretch;
    if (out.input.empty()) out.input = {size->value("width", 0), size->value("height", 0)};
  }
  const double range = json.value("do_rescale", true) ? 255 : 1;
  out.mean = {0, 0, 0};
  out.sigma = {range, range, range};
  const auto mean = read_channels(json, "image_mean"), sigma = read_channels(json, "image_std");
  if (!json.value("do_normalize", false) || !mean || !sigma) return;
  if (std::any_of(sigma->begin(), sigma->end(), [](double s) { return !(s > 0); })) return;
  for (std::size_t i = 0; i < 3; ++i) {
    out.mean[i] = range * (*mean)[i];
    out.sigma[i] = range * (*sigma)[i];
  }
}

// The files that Hugging Face's exporter writes beside a network.
void add_hugging_face(const fs::path& model, Description& out) {
  const nlohmann::json config = read_beside(model, "config.json", out);
  const auto names = config.find("id2label");
  if (!config.is_object() || names == config.end() || !names->is_object()) return;
  std::map<int, std::string> by_id;
  for (const auto& [id, name] : names->items())
    if (const auto number = to_integer(id); number && *number >= 0 && *number < kMaxClasses && name.is_string())
      by_id[*number] = to_lower_case(name.get<std::string>());
  if (by_id.empty()) return;
  out.classes.assign(static_cast<std::size_t>(by_id.rbegin()->first) + 1, "");
  for (const auto& [id, name] : by_id) out.classes[static_cast<std::size_t>(id)] = name;
  const nlohmann::json preparation = read_beside(model, "preprocessor_config.json", out);
  if (preparation.is_object()) add_preparation(preparation, out);
}

}  // namespace

void add_exporter_metadata(const OnnxFile& file, Description& out) {
  if (file.metadata.contains("names"))
    add_ultralytics(file.metadata, out);
  else
    add_hugging_face(file.path, out);
}

}  // namespace dvi::objects
