#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "dvi/core/named.h"

namespace dvi {

using OptionValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

/// The text of a number that the program determines from the data.
inline constexpr const char* kAutomatic = "auto";

/// The smallest and largest value of a number.
struct Range {
  double low = 0, high = 0;
};

/// The intended user of an option. Developer options serve ablations and tuning: `--set` and files accept them like all others,
/// but only `dvi config dump --all` lists them.
enum class Audience { user, developer };

/// A type with a text form: to_string(value) and T::parse(text), which throws std::invalid_argument with the reason.
template <class T>
concept Textual = requires(const T& value, const std::string& text) {
  { to_string(value) } -> std::convertible_to<std::string>;
  { T::parse(text) } -> std::same_as<T>;
};

/// One field of an options struct. The command line, TOML, `--set`, `dvi config dump`, the docs, shell completion, and the
/// keywords of the Python package are made from it.
struct Option {
  std::string section = {}, key = {}, doc = {};
  std::string flag = {};  ///< its short form on the command line, such as "--masks"; empty: none
  Audience audience = Audience::user;
  std::vector<std::string> choices = {};  ///< allowed strings; empty: any string
  bool automatic = false;                 ///< whether a number may be kAutomatic as well
  std::function<OptionValue()> get = {};
  std::function<void(const OptionValue&)> set = {};  ///< throws std::invalid_argument with the reason

  std::string name() const { return section + "." + key; }
  std::string text() const;   ///< returns the value as TOML
  std::string plain() const;  ///< returns text(), for strings without the quotes
  /// Calls set(). Throws UsageError with option, value, and the allowed values if it fails.
  void assign(const OptionValue& value) const;
};

/// A value that a caller gives to an option. Text is parsed by the type of the option: "true", "0.5", or ["a", "b"].
struct Assignment {
  std::string option;  ///< section.key, or the flag
  OptionValue value;

  /// Parses `section.key=value`, the form of `--set`. Throws UsageError if it has no "=".
  static Assignment parse(std::string_view text);
};

/// The only description of all options. The struct of each stage adds its fields, and everything that reads, writes, or
/// documents options uses this table. It holds references to the fields.
class OptionTable {
 public:
  /// Sets the section of the fields that are added next, and their audience to the user.
  void section(std::string name) {
    section_ = std::move(name);
    audience_ = Audience::user;
  }
  /// Sets the audience of the fields up to the next section to developers.
  void developer() { audience_ = Audience::developer; }
  /// Sets whether the fields that are added next get a flag, which is made of their key: --ego-mask for ego_mask.
  void flags(bool wanted) { flags_ = wanted; }

  Option& add(std::string key, bool& field, std::string doc);
  Option& add(std::string key, int& field, Range range, std::string doc);
  Option& add(std::string key, double& field, Range range, std::string doc);
  /// Adds one option that several structs share: it reads the first field and sets all of them.
  Option& add(std::string key, const std::vector<double*>& fields, Range range, std::string doc);
  /// Adds such an option for a number that may be determined by the program; no value means kAutomatic.
  Option& add_automatic(std::string key, const std::vector<std::optional<double>*>& fields, Range range, std::string doc);
  /// Adds a number that has only the allowed values.
  Option& add_one_of(std::string key, int& field, const std::vector<int>& allowed, std::string doc);
  Option& add(std::string key, std::string& field, std::vector<std::string> choices, std::string doc);
  Option& add(std::string key, std::vector<std::string>& field, std::string doc);
  template <Named E>
  Option& add(std::string key, E& field, const std::string& doc) {
    return add_text(std::move(key), list_names<E>(),
                    {[&field] { return to_string(field); }, [&field](const std::string& text) { field = parse_name<E>(text); }},
                    doc);
  }
  template <Textual T>
  Option& add(std::string key, T& field, const std::string& doc) {
    return add_text(std::move(key), {},
                    {[&field] { return to_string(field); }, [&field](const std::string& text) { field = T::parse(text); }},
                    doc);
  }

  /// Adds a list of values, which TOML may also state as one string.
  template <Textual T>
  Option& add(std::string key, std::vector<T>& field, const std::string& doc) {
    return add_list(
        std::move(key),
        [&field] {
          std::vector<std::string> texts;
          for (const T& item : field) texts.push_back(to_string(item));
          return texts;
        },
        [&field](const std::vector<std::string>& texts) {
          std::vector<T> items;
          for (const std::string& text : texts) items.push_back(T::parse(text));
          field = std::move(items);
        },
        doc);
  }

  const std::vector<Option>& options() const { return options_; }

  /// Returns the option of this name, section.key, or with this flag. Throws UsageError with the nearest name for others.
  const Option& find(const std::string& name) const;
  /// Returns the option whose key is this keyword of the Python package: each option with a flag has one. Throws UsageError
  /// with the nearest keyword, those of `others` included, for others.
  const Option& find_keyword(const std::string& keyword, const std::vector<std::string>& others = {}) const;
  /// Assigns a value. Throws UsageError with the allowed values if it is refused.
  void assign(const Assignment& assignment) const;
  void set(std::string_view assignment) const { assign(Assignment::parse(assignment)); }
  /// Sets the options in a TOML file. Skips unknown tables that are in `ignore`. Throws UsageError for others.
  void load_toml(const std::filesystem::path& path, const std::vector<std::string>& ignore = {});
  /// Formats all options, or the wanted ones, with their documentation as TOML that load_toml() can read. Each section is one
  /// table.
  std::string dump_toml(const std::function<bool(const Option&)>& wanted = {}) const;
  /// Formats the same options as a table in Markdown, for the docs.
  std::string dump_markdown(const std::function<bool(const Option&)>& wanted = {}) const;
  /// Throws UsageError for the first field with a value that set() would refuse.
  void check() const;

 private:
  Option& add(Option option);
  struct TextAccess {
    std::function<std::string()> get;
    std::function<void(const std::string&)> set;
  };
  Option& add_text(std::string key, std::vector<std::string> choices, TextAccess field, std::string doc);
  Option& add_list(std::string key, std::function<std::vector<std::string>()> get,
                   std::function<void(const std::vector<std::string>&)> set, std::string doc);

  std::string section_;
  Audience audience_ = Audience::user;
  bool flags_ = false;
  std::vector<Option> options_;
};

/// Implements check() of an options struct: throws UsageError for the first field outside its range.
template <class Described>
void check_ranges(Described options) {
  OptionTable table;
  options.describe(table);
  table.check();
}

}  // namespace dvi
