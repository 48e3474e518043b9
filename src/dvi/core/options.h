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

/// The description of one field of an options struct for TOML, `--set`, `dvi config dump` and the documentation.
struct Option {
  std::string section = {}, key = {}, doc = {};
  Audience audience = Audience::user;
  std::vector<std::string> choices = {};  ///< allowed strings; empty: any string
  bool automatic = false;                 ///< whether a number may be kAutomatic as well
  std::function<OptionValue()> get = {};
  std::function<void(const OptionValue&)> set = {};  ///< throws std::invalid_argument with the reason

  std::string name() const { return section + "." + key; }
  std::string text() const;  ///< the value as TOML
  /// Calls set(). Throws UsageError with option, value and the allowed values if it fails.
  void assign(const OptionValue& value) const;
};

/// The only description of all options. The struct of each stage adds its fields, and everything that reads, writes or
/// documents options uses this table. Holds references to the fields.
class OptionTable {
 public:
  /// Sets the section of the fields that are added next, and their audience to the user.
  void section(std::string name) {
    section_ = std::move(name);
    audience_ = Audience::user;
  }
  /// Sets the audience of the fields up to the next section to developers.
  void developer() { audience_ = Audience::developer; }

  void add(std::string key, bool& field, std::string doc);
  void add(std::string key, int& field, Range range, std::string doc);
  void add(std::string key, double& field, Range range, std::string doc);
  /// Adds one option that several structs share: it reads the first field and sets all of them.
  void add(std::string key, std::vector<double*> fields, Range range, std::string doc);
  /// Adds such an option for a number that may be determined by the program; no value means kAutomatic.
  void add_automatic(std::string key, std::vector<std::optional<double>*> fields, Range range, std::string doc);
  /// Adds a number that has only the allowed values.
  void add_one_of(std::string key, int& field, std::vector<int> allowed, std::string doc);
  void add(std::string key, std::string& field, std::vector<std::string> choices, std::string doc);
  void add(std::string key, std::vector<std::string>& field, std::string doc);
  template <Named E>
  void add(std::string key, E& field, const std::string& doc) {
    add_text(
        std::move(key), list_names<E>(), [&field] { return to_string(field); },
        [&field](const std::string& text) { field = parse_name<E>(text); }, doc);
  }
  template <Textual T>
  void add(std::string key, T& field, const std::string& doc) {
    add_text(
        std::move(key), {}, [&field] { return to_string(field); },
        [&field](const std::string& text) { field = T::parse(text); }, doc);
  }

  const std::vector<Option>& options() const { return options_; }

  /// Applies `section.key=value` of `--set`. Throws UsageError with the remedy if it is malformed.
  void set(std::string_view assignment);
  /// Sets the options in a TOML file. Skips unknown tables that are in `ignore`. Throws UsageError for others.
  void load_toml(const std::filesystem::path& path, const std::vector<std::string>& ignore = {});
  /// Formats all options, or the wanted ones, with their documentation as TOML that load_toml() can read. Each section is one
  /// table.
  std::string dump_toml(const std::function<bool(const Option&)>& wanted = {}) const;
  /// Throws UsageError for the first field with a value that set() would refuse.
  void check() const;

 private:
  void add(Option option);
  void add_text(std::string key, std::vector<std::string> choices, std::function<std::string()> get,
                std::function<void(const std::string&)> set, std::string doc);
  const Option& find(const std::string& name) const;

  std::string section_;
  Audience audience_ = Audience::user;
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
