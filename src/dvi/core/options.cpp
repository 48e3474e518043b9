#include "dvi/core/options.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "dvi/core/error.h"

namespace dvi {
namespace {

double number(const OptionValue& value) {
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* d = std::get_if<double>(&value)) return *d;
  throw std::invalid_argument("a number is wanted");
}

void check(double value, Range range) {
  if (!(value >= range.low && value <= range.high))
    throw std::invalid_argument(fmt::format("{} is outside {} .. {}", value, range.low, range.high));
}

// A bare word is a string, so that the shell's quotes are enough: --set masks.source=labels.
OptionValue parse(std::string_view text, const OptionValue& like) {
  if (std::holds_alternative<std::string>(like)) return std::string(text);
  if (std::holds_alternative<std::vector<std::string>>(like)) return std::vector<std::string>{std::string(text)};
  try {
    const toml::table table = toml::parse(fmt::format("v = {}", text));
    if (table.size() != 1) throw std::invalid_argument("one value is wanted");
    if (const auto b = table["v"].as_boolean()) return b->get();
    if (const auto i = table["v"].as_integer()) return i->get();
    if (const auto d = table["v"].as_floating_point()) return d->get();
  } catch (const toml::parse_error&) {  // answered below
  }
  throw std::invalid_argument(std::holds_alternative<bool>(like) ? "true or false is wanted" : "a number is wanted");
}

OptionValue from_toml(const toml::node& node) {
  if (const auto* b = node.as_boolean()) return b->get();
  if (const auto* i = node.as_integer()) return i->get();
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* s = node.as_string()) return s->get();
  if (const auto* array = node.as_array()) {
    std::vector<std::string> list;
    for (const toml::node& item : *array) {
      if (!item.is_string()) throw std::invalid_argument("a list of strings is wanted");
      list.push_back(item.as_string()->get());
    }
    return list;
  }
  throw std::invalid_argument("a plain value is wanted");
}

std::string to_toml(const OptionValue& value) {
  std::ostringstream out;
  const auto write = [&](const auto& v) {
    using T = std::decay_t<decltype(v)>;
    if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      toml::array array;
      for (const std::string& item : v) array.push_back(item);
      out << array;
    } else {
      out << toml::value<T>(v);
    }
  };
  std::visit(write, value);
  return out.str();
}

}  // namespace

std::string Option::text() const { return to_toml(get()); }

void OptionTable::add(std::string key, bool& field, std::string doc) {
  options_.push_back({section_,
                      std::move(key),
                      std::move(doc),
                      {},
                      [&field] { return OptionValue(field); },
                      [&field](const OptionValue& v) {
                        if (!std::holds_alternative<bool>(v)) throw std::invalid_argument("true or false is wanted");
                        field = std::get<bool>(v);
                      }});
}

void OptionTable::add(std::string key, int& field, Range range, std::string doc) {
  doc += fmt::format(" [{} .. {}]", range.low, range.high);
  options_.push_back({section_,
                      std::move(key),
                      std::move(doc),
                      {},
                      [&field] { return OptionValue(std::int64_t{field}); },
                      [&field, range](const OptionValue& v) {
                        const double d = number(v);
                        if (d != std::floor(d)) throw std::invalid_argument("a whole number is wanted");
                        check(d, range);
                        field = static_cast<int>(d);
                      }});
}

void OptionTable::add(std::string key, double& field, Range range, std::string doc) {
  doc += fmt::format(" [{} .. {}]", range.low, range.high);
  options_.push_back({section_,
                      std::move(key),
                      std::move(doc),
                      {},
                      [&field] { return OptionValue(field); },
                      [&field, range](const OptionValue& v) {
                        check(number(v), range);
                        field = number(v);
                      }});
}

void OptionTable::add(std::string key, std::string& field, std::vector<std::string> choices, std::string doc) {
  if (!choices.empty()) doc += fmt::format(" [{}]", fmt::join(choices, " | "));
  options_.push_back({section_, std::move(key), std::move(doc), choices, [&field] { return OptionValue(field); },
                      [&field, choices](const OptionValue& v) {
                        const auto* s = std::get_if<std::string>(&v);
                        if (s == nullptr) throw std::invalid_argument("a string is wanted");
                        if (!choices.empty() && std::find(choices.begin(), choices.end(), *s) == choices.end())
                          throw std::invalid_argument(fmt::format("'{}' is none of {}", *s, fmt::join(choices, ", ")));
                        field = *s;
                      }});
}

void OptionTable::add(std::string key, std::vector<std::string>& field, std::string doc) {
  options_.push_back({section_,
                      std::move(key),
                      std::move(doc),
                      {},
                      [&field] { return OptionValue(field); },
                      [&field](const OptionValue& v) {
                        const auto* list = std::get_if<std::vector<std::string>>(&v);
                        if (list == nullptr) throw std::invalid_argument("a list of strings is wanted");
                        field = *list;
                      }});
}

const Option& OptionTable::find(const std::string& name) const {
  const auto it = std::find_if(options_.begin(), options_.end(), [&](const Option& o) { return o.name() == name; });
  if (it == options_.end()) throw UsageError(fmt::format("there is no option '{}'; `dvi config dump` lists all of them", name));
  return *it;
}

void OptionTable::set(std::string_view assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos) throw UsageError(fmt::format("--set {}: wanted is section.key=value", assignment));
  const Option& option = find(std::string(assignment.substr(0, equals)));
  try {
    option.set(parse(assignment.substr(equals + 1), option.get()));
  } catch (const std::invalid_argument& e) {
    throw UsageError(fmt::format("option {}: {}", option.name(), e.what()));
  }
}

void OptionTable::load_toml(const std::filesystem::path& path, const std::vector<std::string>& ignore) {
  toml::table table;
  try {
    table = toml::parse_file(path.string());
  } catch (const toml::parse_error& e) {
    throw UsageError(fmt::format("{}:{}: {}", path.string(), e.source().begin.line, e.description()));
  }
  for (const auto& [section, node] : table) {
    const std::string name(section.str());
    if (std::find(ignore.begin(), ignore.end(), name) != ignore.end()) continue;
    if (!node.is_table()) throw UsageError(fmt::format("{}: '{}' stands outside any table", path.string(), name));
    for (const auto& [key, value] : *node.as_table()) {
      const std::string full_name = fmt::format("{}.{}", name, key.str());
      try {
        find(full_name).set(from_toml(value));
      } catch (const std::invalid_argument& e) {
        throw UsageError(fmt::format("{}: option {}: {}", path.string(), full_name, e.what()));
      } catch (const UsageError& e) {
        throw UsageError(fmt::format("{}: {}", path.string(), e.what()));
      }
    }
  }
}

std::string OptionTable::dump_toml() const {
  std::string text, section;
  for (const Option& option : options_) {
    if (option.section != section) {
      section = option.section;
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("# {}\n{} = {}\n", option.doc, option.key, option.text());
  }
  return text;
}

}  // namespace dvi
