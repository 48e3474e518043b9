#include "dvi/core/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "dvi/core/error.h"
#include "dvi/core/nearest_word.h"
#include "dvi/core/toml_file.h"
#include "dvi/core/toml_text.h"

namespace dvi {
namespace {

double to_number_value(const OptionValue& value) {
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* d = std::get_if<double>(&value)) return *d;
  throw std::invalid_argument("must be a number");
}

double to_whole_number(const OptionValue& value) {
  const double d = to_number_value(value);
  if (d != std::floor(d)) throw std::invalid_argument("must be a whole number");
  return d;
}

double require_within(double value, Range range) {
  if (!(value >= range.low && value <= range.high))
    throw std::invalid_argument(fmt::format("must be within {} .. {}", range.low, range.high));
  return value;
}

template <class T>
T require(const OptionValue& value, const char* reason) {
  if (!std::holds_alternative<T>(value)) throw std::invalid_argument(reason);
  return std::get<T>(value);
}

template <class T>
OptionValue to_value(const T& field) {
  if constexpr (std::is_same_v<T, std::optional<double>>)
    return field ? OptionValue(*field) : OptionValue(kAutomatic);
  else if constexpr (std::is_same_v<T, int>)
    return std::int64_t{field};
  else
    return field;
}

OptionValue from_toml(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return b->get();
  if (const auto* i = node.as_integer()) return i->get();
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* s = node.as_string()) return from_toml_text(s->get());
  if (const auto* array = node.as_array()) {
    std::vector<std::string> list;
    for (const toml::node& item : *array) {
      if (!item.is_string()) throw std::invalid_argument("must be a list of strings");
      list.push_back(from_toml_text(item.as_string()->get()));
    }
    return list;
  }
  throw std::invalid_argument("must be a plain value");
}

// Parses numbers in forms that TOML does not allow: ".5", "5.", "+1.5".
std::optional<double> parse_decimal(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  const bool whole_text = error == std::errc() && end == text.data() + text.size() && text.find('.') != std::string_view::npos;
  return whole_text ? std::optional(value) : std::nullopt;
}

// Parses a value by the type of its option. A bare word is a string, so that no quotes within the shell's are needed.
OptionValue parse_value(std::string_view text, const Option& option) {
  if (option.automatic && text == kAutomatic) return std::string(text);
  const OptionValue like = option.automatic ? OptionValue(0.0) : option.get();
  if (std::holds_alternative<std::string>(like)) return std::string(text);
  const bool list = std::holds_alternative<std::vector<std::string>>(like);
  if (list && !text.starts_with('[')) return std::vector<std::string>{std::string(text)};
  try {
    const toml::table table = toml::parse(fmt::format("v = {}", text));
    if (table.size() != 1) throw std::invalid_argument("must be one value");
    if (const auto b = table["v"].as_boolean()) return b->get();
    if (const auto i = table["v"].as_integer()) return i->get();
    if (const auto d = table["v"].as_floating_point()) return d->get();
    if (list && table["v"].is_array()) return from_toml(*table.get("v"));
  } catch (const std::runtime_error&) {  // malformed (parse_error, TOML_ASSERT): answered below
  }
  if (const auto d = parse_decimal(text)) return *d;
  throw std::invalid_argument(list                                 ? "must be a list of strings"
                              : std::holds_alternative<bool>(like) ? "must be true or false"
                                                                   : "must be a number");
}

std::string suggest(const std::string& name, const std::vector<std::string>& names) {
  const std::string meant = nearest_word(name, names);
  return meant.empty() ? "" : fmt::format(" (did you mean '{}'?)", meant);
}

std::string to_toml(const OptionValue& value) {
  std::ostringstream out;
  const auto write = [&](const auto& v) {
    using T = std::decay_t<decltype(v)>;
    if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      toml::array array;
      for (const std::string& item : v) array.push_back(to_toml_text(item));
      out << array;
    } else if constexpr (std::is_same_v<T, std::string>) {
      out << toml::value<T>(to_toml_text(v));
    } else if constexpr (std::is_same_v<T, double>) {
      const std::string shortest = fmt::format("{}", v);  // 0.1 instead of 0.10000000000000001 of the library
      out << shortest << (shortest.find_first_of(".en") == std::string::npos ? ".0" : "");
    } else {
      out << toml::value<T>(v);
    }
  };
  std::visit(write, value);
  return out.str();
}

// Connects an option with its fields: it reads the first one, and sets all of them to the result of `read`.
template <class T, class Read>
Option& connect(Option& option, const std::vector<T*>& fields, const Read& read) {
  option.get = [first = fields.front()] { return to_value(*first); };
  option.set = [fields, read](const OptionValue& v) {
    const T value = read(v);
    for (T* field : fields) *field = value;
  };
  return option;
}

}  // namespace

std::string Option::text() const { return to_toml(get()); }

std::string Option::plain() const {
  const OptionValue value = get();
  const auto* string = std::get_if<std::string>(&value);
  return string != nullptr ? *string : to_toml(value);
}

void Option::assign(const OptionValue& value) const {
  try {
    set(value);
  } catch (const std::invalid_argument& e) {
    throw UsageError(fmt::format("option {} = {}: {}", name(), to_toml(value), e.what()));
  }
}

Option& OptionTable::add(Option option) {
  option.section = section_;
  option.audience = audience_;
  if (flags_) {
    option.flag = "--" + option.key;
    std::replace(option.flag.begin(), option.flag.end(), '_', '-');
  }
  options_.push_back(std::move(option));
  return options_.back();
}

Option& OptionTable::add(std::string key, bool& field, std::string doc) {
  return connect(add({.key = std::move(key), .doc = std::move(doc)}), std::vector{&field},
                 [](const OptionValue& v) { return require<bool>(v, "must be true or false"); });
}

Option& OptionTable::add(std::string key, int& field, Range range, std::string doc) {
  doc += fmt::format(" [{} .. {}]", range.low, range.high);
  return connect(add({.key = std::move(key), .doc = std::move(doc)}), std::vector{&field},
                 [range](const OptionValue& v) { return static_cast<int>(require_within(to_whole_number(v), range)); });
}

Option& OptionTable::add_one_of(std::string key, int& field, const std::vector<int>& allowed, std::string doc) {
  doc += fmt::format(" [{}]", fmt::join(allowed, " | "));
  return connect(add({.key = std::move(key), .doc = std::move(doc)}), std::vector{&field}, [allowed](const OptionValue& v) {
    const auto it = std::find(allowed.begin(), allowed.end(), to_whole_number(v));
    if (it == allowed.end()) throw std::invalid_argument(fmt::format("must be one of {}", fmt::join(allowed, ", ")));
    return *it;
  });
}

Option& OptionTable::add(std::string key, double& field, Range range, std::string doc) {
  return add(std::move(key), std::vector{&field}, range, std::move(doc));
}

Option& OptionTable::add(std::string key, const std::vector<double*>& fields, Range range, std::string doc) {
  doc += fmt::format(" [{} .. {}]", range.low, range.high);
  return connect(add({.key = std::move(key), .doc = std::move(doc)}), fields,
                 [range](const OptionValue& v) { return require_within(to_number_value(v), range); });
}

Option& OptionTable::add_automatic(std::string key, const std::vector<std::optional<double>*>& fields, Range range,
                                   std::string doc) {
  doc += fmt::format(" [{} | {} .. {}]", kAutomatic, range.low, range.high);
  const auto read = [range](const OptionValue& v) {
    return v == OptionValue(kAutomatic) ? std::nullopt : std::optional(require_within(to_number_value(v), range));
  };
  Option& option = connect(add({.key = std::move(key), .doc = std::move(doc)}), fields, read);
  option.automatic = true;
  return option;
}

Option& OptionTable::add(std::string key, std::vector<std::string>& field, std::string doc) {
  return connect(add({.key = std::move(key), .doc = std::move(doc)}), std::vector{&field},
                 [](const OptionValue& v) { return require<std::vector<std::string>>(v, "must be a list of strings"); });
}

Option& OptionTable::add(std::string key, std::string& field, std::vector<std::string> choices, std::string doc) {
  auto set = [&field, choices](const std::string& text) {
    if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end()) refuse_name(choices);
    field = text;
  };
  return add_text(std::move(key), std::move(choices), {[&field] { return field; }, std::move(set)}, std::move(doc));
}

Option& OptionTable::add_text(std::string key, std::vector<std::string> choices, TextAccess field, std::string doc) {
  if (!choices.empty()) doc += fmt::format(" [{}]", fmt::join(choices, " | "));
  return add({.key = std::move(key),
              .doc = std::move(doc),
              .choices = std::move(choices),
              .get = std::move(field.get),
              .set = [set = std::move(field.set)](const OptionValue& v) { set(require<std::string>(v, "must be a string")); }});
}

Option& OptionTable::add_list(std::string key, std::function<std::vector<std::string>()> get,
                              std::function<void(const std::vector<std::string>&)> set, std::string doc) {
  return add({.key = std::move(key),
              .doc = std::move(doc),
              .get = std::move(get),
              .set = [set = std::move(set)](const OptionValue& v) {
                if (const auto* text = std::get_if<std::string>(&v)) return set({*text});
                set(require<std::vector<std::string>>(v, "must be a string or a list of strings"));
              }});
}

const Option& OptionTable::find(const std::string& name) const {
  std::vector<std::string> names;
  for (const Option& option : options_) {
    if (name == option.name() || (name == option.flag && !name.empty())) return option;
    names.push_back(option.name());
  }
  throw UsageError(
      fmt::format("there is no option '{}'{}; `dvi config dump --all` lists all options", name, suggest(name, names)));
}

const Option& OptionTable::find_keyword(const std::string& keyword, const std::vector<std::string>& others) const {
  std::vector<std::string> keywords = others;
  for (const Option& option : options_) {
    if (option.flag.empty()) continue;
    if (option.key == keyword) return option;
    keywords.push_back(option.key);
  }
  throw UsageError(fmt::format("there is no option '{}'{}", keyword, suggest(keyword, keywords)));
}

Assignment Assignment::parse(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) throw UsageError(fmt::format("--set {}: must be section.key=value", text));
  return {std::string(text.substr(0, equals)), std::string(text.substr(equals + 1))};
}

void OptionTable::assign(const Assignment& assignment) const {
  const Option& option = find(assignment.option);
  const bool flag = assignment.option == option.flag;
  const auto* text = std::get_if<std::string>(&assignment.value);
  std::string shown = text != nullptr ? *text : to_toml(assignment.value);
  try {
    const OptionValue value = text != nullptr ? parse_value(*text, option) : assignment.value;
    if (!flag) shown = to_toml(value);
    option.set(value);
  } catch (const std::invalid_argument& e) {
    const std::string what = flag ? option.flag + " " : fmt::format("option {} = ", option.name());
    throw UsageError(fmt::format("{}{}: {}", what, shown, e.what()));
  }
}

void OptionTable::load_toml(const std::filesystem::path& path, const std::vector<std::string>& ignore) {
  toml::table table;
  try {
    table = read_toml(path);
  } catch (const InputError& e) {
    throw UsageError(e.what());
  }
  for (const auto& [section, node] : table) {
    const std::string name(section.str());
    if (std::find(ignore.begin(), ignore.end(), name) != ignore.end()) continue;
    if (!node.is_table()) throw UsageError(fmt::format("{}: '{}' is outside any table", path.string(), name));
    for (const auto& [key, value] : *node.as_table()) {
      const std::string full_name = fmt::format("{}.{}", name, key.str());
      try {
        find(full_name).assign(from_toml(value));
      } catch (const std::invalid_argument& e) {
        throw UsageError(fmt::format("{}: option {}: {}", path.string(), full_name, e.what()));
      } catch (const UsageError& e) {
        throw UsageError(fmt::format("{}: {}", path.string(), e.what()));
      }
    }
  }
}

std::string OptionTable::dump_toml(const std::function<bool(const Option&)>& wanted) const {
  std::vector<std::pair<std::string, std::string>> sections;
  for (const Option& option : options_) {
    if (wanted && !wanted(option)) continue;
    auto it = std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.first == option.section; });
    if (it == sections.end()) it = sections.insert(it, {option.section, ""});
    it->second += fmt::format("# {}\n{} = {}\n", option.doc, option.key, option.text());
  }
  std::string text;
  for (const auto& [name, lines] : sections) text += fmt::format("{}[{}]\n{}", text.empty() ? "" : "\n", name, lines);
  return text;
}

std::string OptionTable::dump_markdown(const std::function<bool(const Option&)>& wanted) const {
  std::string text = "| option | command line | default | meaning |\n|---|---|---|---|\n";
  const auto code = [](const std::string& word) { return word.empty() ? "" : fmt::format("`{}`", word); };
  for (const Option& option : options_) {
    if (wanted && !wanted(option)) continue;
    std::string doc = option.doc;
    for (std::size_t i = doc.find('|'); i != std::string::npos; i = doc.find('|', i + 2)) doc.insert(i, "\\");
    text += fmt::format("| {} | {} | {} | {} |\n", code(option.name()), code(option.flag), code(option.plain()), doc);
  }
  return text;
}

void OptionTable::check() const {
  for (const Option& option : options_) option.assign(option.get());
}

}  // namespace dvi
