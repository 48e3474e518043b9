#include "dvi/objects/detect/description.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"
#include "dvi/core/toml_file.h"

namespace dvi::objects {
namespace {

// The limits of a description.
struct DescriptionLimits {
  double min_side_px = 8;  ///< in a smaller input, no object is recognizable
  double max_side_px = 8192;
  double max_input_px = 1 << 24;  ///< a larger blob takes gigabytes
  std::size_t max_names = 10'000;
};
constexpr DescriptionLimits kLimits{};

// One table of the file, which may be missing. Throws InputError with file and line.
class Section {
 public:
  Section(const fs::path& file, const toml::table& root, std::string name, const std::vector<std::string>& keys)
      : file_(file), name_(std::move(name)), table_(root.get_as<toml::table>(name_)) {
    if (!table_ && root.contains(name_))
      fail(*root.get(name_), fmt::format("'{}' is not a table", name_), fmt::format("write [{}]", name_));
    if (!table_) return;
    for (const auto& [key, node] : *table_)
      if (std::find(keys.begin(), keys.end(), key.str()) == keys.end())
        fail(node, fmt::format("[{}] has no key '{}'", name_, key.str()), fmt::format("it has {}", fmt::join(keys, ", ")));
  }

  bool has(const char* key) const { return table_ && table_->contains(key); }

  double number(const char* key, double standard, double least, double most) const {
    if (!has(key)) return standard;
    const auto value = table_->get(key)->value<double>();
    if (!value || !(*value >= least && *value <= most))
      fail(key, fmt::format("is not a number from {:g} to {:g}", least, most));
    return *value;
  }
  template <std::size_t N>
  std::array<double, N> numbers(const char* key) const {
    const toml::array* list = table_->get(key)->as_array();
    std::array<double, N> out;
    for (std::size_t i = 0; i < N; ++i) {
      const auto value = list && list->size() == N ? (*list)[i].value<double>() : std::nullopt;
      if (!value || !std::isfinite(*value)) fail(key, fmt::format("is not a list of {} numbers", N));
      out[i] = *value;
    }
    return out;
  }
  std::vector<std::string> words(const char* key) const {
    const toml::array* list = table_->get(key)->as_array();
    if (!list || list->empty() || list->size() > kLimits.max_names) fail(key, "is not a list of names");
    std::vector<std::string> out;
    for (const toml::node& node : *list) {
      if (!node.is_string()) fail(key, "is not a list of names");
      out.push_back(node.value_or(std::string()));
    }
    return out;
  }
  std::optional<std::string> text(const char* key) const { return table_->get(key)->value<std::string>(); }
  template <Named E>
  E choice(const char* key, E standard) const {
    if (!has(key)) return standard;
    try {
      return parse_name<E>(text(key).value_or(""));
    } catch (const std::invalid_argument& e) {
      fail(key, e.what());
    }
  }
  [[noreturn]] void fail(const char* key, const std::string& problem) const {
    fail(*table_->get(key), fmt::format("[{}] '{}' {}", name_, key, problem), "see docs/detector.md");
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& problem, const std::string& remedy) const {
    throw InputError(fmt::format("{}:{}", file_.string(), node.source().begin.line), problem, remedy);
  }

  fs::path file_;
  std::string name_;
  const toml::table* table_;
};

cv::Size read_input_size(const Section& section) {
  const auto [width, height] = section.numbers<2>("size");
  for (const double side : {width, height})
    if (!(side >= kLimits.min_side_px && side <= kLimits.max_side_px && side == std::floor(side)))
      section.fail("size",
                   fmt::format("is not [width, height] in pixels, {} to {} each", kLimits.min_side_px, kLimits.max_side_px));
  if (width * height > kLimits.max_input_px) section.fail("size", "has more than 2^24 pixels");
  return {static_cast<int>(width), static_cast<int>(height)};
}

void read_input(const Section& section, Description& out) {
  if (section.has("size")) out.input = read_input_size(section);
  out.fit = section.choice("fit", out.fit);
  if (out.fit == Fit::stretch && section.has("pad")) section.fail("pad", "has no meaning with fit = \"stretch\"");
  out.pad = section.number("pad", out.pad, 0, 255);
  out.channels = section.choice("channels", out.channels);
  if (section.has("mean")) out.mean = section.numbers<3>("mean");
  if (section.has("std")) out.sigma = section.numbers<3>("std");
  for (const double s : out.sigma)
    if (!(s > 0) && section.has("std")) section.fail("std", "is not positive");
}

void read_output(const Section& section, Description& out) {
  out.layout = section.choice("kind", out.layout);
  if (section.has("names")) out.outputs = section.words("names");
  if (out.layout == Layout::semantic)
    for (const char* key : {"score", "nms"})
      if (section.has(key)) section.fail(key, "has no meaning with kind = \"semantic\": each pixel has its best class");
  out.score = section.number("score", out.score, 0.001, 1);
  out.nms = section.number("nms", out.nms, 0, 1);
  out.least_pixels = static_cast<int>(section.number("least_pixels", out.least_pixels, 1, 1e6));
}

void read_class_names(const Section& section, Description& out) {
  out.classes.clear();
  if (const auto data_set = section.text("names")) {
    out.classes = list_known_classes(*data_set);
    if (out.classes.empty()) section.fail("names", "is neither a list of names nor COCO, COCO-91, or Cityscapes");
    return;
  }
  for (const std::string& name : section.words("names")) out.classes.push_back(to_lower_case(name));
}

void read_classes(const Section& section, Description& out) {
  if (section.has("names")) read_class_names(section, out);
  if (out.layout == Layout::semantic && section.has("names") && out.classes.size() == 1)
    section.fail("names", "has one class, but kind = \"semantic\" also needs the class of the background");
  if (!section.has("remove")) return;
  for (const std::string& name : section.words("remove")) {
    const std::string& word = *out.chosen.insert(to_lower_case(name)).first;
    if (std::find(out.classes.begin(), out.classes.end(), word) == out.classes.end())
      section.fail("remove", fmt::format("has '{}', which is not the name of a class", name));
  }
}

}  // namespace

void add_model_toml(const fs::path& toml, Description& out) {
  out.files.push_back(toml);
  const toml::table root = read_toml(toml);
  for (const auto& [key, node] : root)
    if (key.str() != "input" && key.str() != "output" && key.str() != "classes")
      throw InputError(fmt::format("{}:{}", toml.string(), node.source().begin.line),
                       fmt::format("[{}] is not one of [input], [output], [classes]", key.str()), "see docs/detector.md");
  read_input({toml, root, "input", {"size", "fit", "pad", "channels", "mean", "std"}}, out);
  read_output({toml, root, "output", {"kind", "names", "score", "nms", "least_pixels"}}, out);
  read_classes({toml, root, "classes", {"names", "remove"}}, out);
}

}  // namespace dvi::objects
